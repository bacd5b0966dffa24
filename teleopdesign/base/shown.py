"""Results ask for their looks: text, table in a notebook, figure, sentences.

    @dataclass(frozen=True, eq=False)
    class MarginMap(Shown, ByValue):

        def plot(self) -> Figure:
            return figure_of(self)

What a result looks like stands in `show`, in the file named as the folder of the result's class.
`_registry` is the one import of the package that goes against the direction of imports.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cache
from html import escape
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

from .frozen import repr_by_fields

if TYPE_CHECKING:
    import matplotlib.figure

#: text: in a terminal;  table: HTML in a notebook;  figure: of a result's `plot`;  sentence, notes,
#: findings: of its properties of that name;  all others: further figures, of methods of that name
LookKind = Literal[
    "text", "table", "figure", "sentence", "notes", "findings",
    "nyquist", "curves", "map", "panels", "scatter", "sensitivity",
]  # fmt: skip


class Shown:
    """Base of frozen dataclasses whose looks stand in `show`.

    Printed, a result is its text, or its fields where it has no text; in a notebook it is its
    table, or its text where it has no table.
    """

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if "__repr__" not in vars(cls):  # a dataclass would write one of its fields
            cls.__repr__ = Shown.__repr__  # type: ignore[method-assign]

    def __repr__(self) -> str:
        text = _registry().look_of("text", type(self))
        return repr_by_fields(self) if text is None else str(text(self))

    def _repr_html_(self) -> str | None:
        table = _registry().look_of("table", type(self))
        return None if table is None else str(table(self))


def look(result: object, kind: LookKind, /, *arguments: Any, **options: Any) -> Any:
    """A look of a result; arguments and options are those of the function in `show`.

    raises TypeError: `show` has no such look of this class
    """
    function = _registry().look_of(kind, type(result))
    if function is None:
        raise TypeError(f"show: no {kind} of {type(result).__name__}")
    return function(result, *arguments, **options)


def figure_of(
    result: object, /, *arguments: Any, kind: LookKind = "figure", **options: Any
) -> matplotlib.figure.Figure:
    """The figure of a result; arguments and options are those of its method `plot`."""
    figure: matplotlib.figure.Figure = look(result, kind, *arguments, **options)
    return figure


@cache
def _registry() -> Any:
    return import_module(f"{__name__.partition('.')[0]}.show.registry")


#: most rows of a table in a notebook
MOST_ROWS = 40


def html_table(
    title: str, head: Sequence[str], rows: Iterable[Sequence[object]], *, note: str = ""
) -> str:
    """An HTML table with a title above, and with `note` below unless it is "".

    At most MOST_ROWS rows are shown; a last row counts the others.
    """
    listed = [tuple(map(str, row)) for row in rows]
    more = len(listed) - MOST_ROWS
    if more > 0:
        listed = [*listed[:MOST_ROWS], (f"... and {more} more", *[""] * (len(head) - 1))]
    body = "".join(f"<tr>{_cells(row, 'td')}</tr>" for row in listed)
    top = f"<thead><tr>{_cells(head, 'th')}</tr></thead>" if any(head) else ""
    below = f"<p>{escape(note)}</p>" if note else ""
    return (
        f"<div><p><b>{escape(title)}</b></p><table>{top}<tbody>{body}</tbody></table>{below}</div>"
    )


def _cells(row: Sequence[str], tag: str) -> str:
    return "".join(f"<{tag} style='text-align:left'>{escape(cell)}</{tag}>" for cell in row)
