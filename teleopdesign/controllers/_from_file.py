"""A control law of one's own, from a file written as those of this folder are."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from weakref import WeakValueDictionary

from ..errors import ModelError, TeleopDesignError
from ..names import check_name
from ..recipes import file_digest, remember
from ._controller import ControlLaw

_LOADED: WeakValueDictionary[tuple[Path, str], ControlLaw] = WeakValueDictionary()


def load_controller(path: str | Path) -> ControlLaw:
    """Read one file of a control law; the name of the file becomes the name of the law.

    It is used as a law of the catalogue is: `controller(load_controller("my_law.py"), values)`.
    A file that has not changed since gives the same law again.
    raises ModelError: the file cannot be read or run, or defines no CONTROLLER
    """
    path = Path(path)
    if not path.is_file():
        raise ModelError(f"{path}: no such file of a control law")
    if not path.stem.isidentifier():
        raise ModelError(f'{path}: the file name "{path.stem}" must be a name such as my_law.py')
    return _of_file(path.resolve(), path)


def _of_file(path: Path, written: Path, expected: str = "") -> ControlLaw:
    """The law of a file.

    written: the path as the user wrote it;  expected: digest that the file must have
    """
    digest = file_digest(path, written, "control law", expected)
    law = _LOADED.get((path, digest))
    if law is None:
        law = remember(_read(written), _of_file, path, written, digest)
        _LOADED[path, digest] = law
    return law


def _read(path: Path) -> ControlLaw:
    spec = importlib.util.spec_from_file_location(f"{__package__}.{path.stem}", path)
    if spec is None or spec.loader is None:
        raise ModelError(f"{path}: found a file of kind {path.suffix!r}, expected .py")
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except TeleopDesignError as error:
        raise ModelError(f"{path}: {error}") from error
    except Exception as error:  # any failure of a user's file is reported, with its kind
        raise ModelError(f"{path}: {type(error).__name__}: {error}") from error
    law = getattr(module, "CONTROLLER", None)
    if not isinstance(law, ControlLaw):
        raise ModelError(f"{path}: found no CONTROLLER = ControlLaw(...)")
    for name in law.parameters:
        check_name(name, where=f"{path}")
    return law.named(path.stem, module.__doc__ or "")
