"""A user's control law, from a file of the same form as those in this folder."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from weakref import WeakValueDictionary

from ..base.errors import ModelError, check_name
from ..base.recipes import checked_path, laws_of, load_once, run
from ._controller import ControlLaw
from ._declarations import broken_declarations, unknown_symbols

_LOADED: WeakValueDictionary[tuple[Path, str], ControlLaw] = WeakValueDictionary()


def load_controller(path: str | Path) -> ControlLaw:
    """Read a file with a control law; the name of the file becomes the name of the law.

    Use the law like one of the catalogue, `controller(load_controller("my_law.py"), values)`. An
    unchanged file returns the same law again.

    raises ModelError: the file cannot be read or run, defines no CONTROLLER, or one whose
        declarations are wrong
    """
    path = checked_path(path, "control law", "my_law.py")
    return _load_law(path.resolve(), path)


def _load_law(path: Path, written: Path, expected: str = "") -> ControlLaw:
    """The law in a file.

    written: path of the file in messages;  expected: digest that the file must have, "" for any
    """

    def read(content: bytes) -> ControlLaw:
        return _check_law(run(content, written, str(__package__)), written)

    return load_once(_LOADED, _load_law, read, path, written, expected)


def _check_law(module: ModuleType, path: Path) -> ControlLaw:
    law = getattr(module, "CONTROLLER", None)
    if not isinstance(law, ControlLaw):
        raise ModelError(f"{path}: found no CONTROLLER = ControlLaw(...)")
    for name in (*law.parameters, *law.states):
        check_name(name, where=f"{path}")
    if both := set(law.parameters) & set(law.states):
        raise ModelError(f'{path}: "{min(both)}" is a parameter and a state: call one otherwise')
    law = law.named(path.stem, module.__doc__ or "")
    with laws_of(path, law.parameters):
        if strange := unknown_symbols(law):
            raise ModelError(f"{path}: law uses {', '.join(map(str, strange))}")
        broken = broken_declarations(law)
    if broken:
        raise ModelError(f"{path}: declares {broken[0]}")
    return law
