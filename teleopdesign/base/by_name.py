"""Results whose parts are got by name."""

from __future__ import annotations

from collections.abc import Iterable, Iterator


class ByName:
    """A result with parts by name: `name in result` and `for name in result`, as for a dict.

    Without both, Python asks `result[0]`, `result[1]` ... instead, and gets an error about "0".
    """

    def _names(self) -> Iterable[str]:
        """The names that `result[name]` takes."""
        raise NotImplementedError

    def __iter__(self) -> Iterator[str]:
        return iter(self._names())

    def __contains__(self, name: object) -> bool:
        return name in tuple(self._names())
