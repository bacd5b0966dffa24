"""A function checks its arguments against its declared types before it computes anything.

    @check_types
    def sine(*, amplitude: float) -> Motion     # sine(amplitude="2 mm") is refused in one line

A wrong type is refused at the call. The message says what the value is, what was expected, and the
nearest match where names are expected. Numbers are finite or infinite, never NaN, True or a text.
An argument that the function does not have raises TypeError, as in any Python.
"""

from __future__ import annotations

import ast
import inspect
import sys
import types
from collections.abc import Callable, Iterable, Mapping
from functools import cache, wraps
from importlib import import_module
from importlib.util import resolve_name
from itertools import chain, repeat
from typing import Any, TypeVar

from .errors import ExperimentError, ModelError
from .expectations import (
    TypeCheck,
    WrongValue,
    check_of,
    describe_value,
    number_check,
    with_article,
)

__all__ = [
    "check_arguments",
    "check_types",
    "checked_in_place",
    "conforming",
    "describe_value",
    "instance",
    "matrix_of",
    "number",
]

Target = TypeVar("Target", bound=Callable[..., Any])

_PACKAGE = __name__.partition(".")[0]
#: folders whose functions raise ExperimentError for a wrong argument
_OF_EXPERIMENTS = ("measurement", "examples", "block_cuts")


def check_types(target: Target) -> Target:
    """The function, with its arguments checked; for a dataclass, the arguments of its constructor.

    Annotations that only type checkers can resolve, and `Any`, are not checked.
    """
    whole: Any = target
    function: Callable[..., Any] = whole.__init__ if isinstance(target, type) else target
    if hasattr(function, "_is_checked"):
        return target
    name = target.__name__
    if not isinstance(target, type) and "." in (qualified := target.__qualname__):
        name = qualified.rpartition("<locals>.")[2]

    @cache  # at the first call: what annotations name may be defined later than the function
    def declared() -> tuple[tuple[str, ...], str, dict[str, TypeCheck]]:
        """Parameters by position, the name of `*arguments` or "", and the checks by parameter."""
        names = vars(sys.modules[target.__module__])
        parameters = inspect.signature(function).parameters.values()
        by_parameter = {p.name: check_of(_resolve(p.annotation, names)) for p in parameters}
        checks = {
            p.name: _allow_default(check, p.default)
            for p in parameters
            if (check := by_parameter[p.name]) is not None
        }
        in_order = (p for p in parameters if p.kind not in (p.KEYWORD_ONLY, p.VAR_POSITIONAL))
        more = next((p.name for p in parameters if p.kind is p.VAR_POSITIONAL), "")
        return tuple(p.name for p in in_order), more, checks

    @wraps(function)
    def call(*arguments: Any, **named: Any) -> Any:
        in_order, more, checks = declared()
        listed = in_order if len(arguments) <= len(in_order) else chain(in_order, repeat(more))
        for key, value in chain(zip(listed, arguments, strict=False), named.items()):
            check = checks.get(key)
            if check is not None and (wrong := check(value)) is not None:
                raise _error(target.__module__, name, key, wrong)
        return function(*arguments, **named)

    call._is_checked = True  # type: ignore[attr-defined]
    if isinstance(target, type):
        target.__init__ = call  # type: ignore[misc]
        return target
    return call  # type: ignore[return-value]


def check_arguments(names: dict[str, Any], public: Iterable[str]) -> None:
    """Replace every public function in `names` by the same function with its arguments checked.

    names: the names of a folder (`globals()`); changed in place
    public: the names of its public functions
    """
    names |= {name: checked_in_place(names[name]) for name in public}


def checked_in_place(value: Any) -> Any:
    """A function with its arguments checked, in its module too; any other value as it is."""
    if isinstance(value, types.FunctionType) and not hasattr(value, "_is_checked"):
        value = check_types(value)
        # a function pickles as what its module has under its name
        setattr(sys.modules[value.__module__], value.__name__, value)
    return value


def number(value: Any, where: str) -> float:
    """The value as a float; raises ModelError for a text, True, None, NaN and the like."""
    if (wrong := number_check(value)) is not None:
        raise _error("", "", where, wrong)
    return float(value)


def instance(value: Any, kind: type[Any], where: str, *, expected: str = "") -> None:
    """Raise ModelError unless the value is an instance of the class `kind`.

    where: beginning of the message;  expected: words for what was expected; "": the class name
    """
    if not isinstance(value, kind):
        raise _error("", "", where, WrongValue("", value, expected or with_article(kind.__name__)))


def conforming(value: Any, annotation: Any, where: str) -> None:
    """Raise ModelError unless the value is of the type that an annotation states."""
    check = check_of(annotation)
    if check is not None and (wrong := check(value)) is not None:
        raise _error("", "", where, wrong)


def matrix_of(value: Any, where: str) -> Any:
    """A matrix of numbers as an array (n, m) of floats; raises ModelError for any other value."""
    import numpy as np

    expected = "a matrix of numbers, such as [[1, 0], [0, 1]]"
    try:
        matrix = np.asarray(value)
    except ValueError:  # rows of different lengths
        matrix = np.empty(0, dtype=object)
    if matrix.dtype.kind not in "iuf" or matrix.ndim != 2 or bool(np.any(matrix != matrix)):
        raise _error("", "", where, WrongValue("", value, expected))
    return matrix.astype(float)


def _error(module: str, function: str, argument: str, wrong: WrongValue) -> Exception:
    of_experiment = any(module.startswith(f"{_PACKAGE}.{f}") for f in _OF_EXPERIMENTS)
    kind = ExperimentError if of_experiment else ModelError
    where = f"{function}: {argument}" if function else argument
    return kind(
        f"{where}{wrong.place}: found {describe_value(wrong.value)}, expected {wrong.expected}"
        f"{wrong.hint}"
    )


def _resolve(annotation: Any, names: Mapping[str, Any]) -> Any:
    if annotation is inspect.Parameter.empty:
        return Any
    if not isinstance(annotation, str):
        return annotation
    known = dict(names)
    for _ in range(_MOST_NAMES):
        try:
            return eval(annotation, known)  # the package's annotation, not a user's text
        except NameError as missing:
            name = missing.name or ""
            known[name] = _find_type_import(names["__name__"], name)
    return Any


_MOST_NAMES = 9  # most names of one annotation that are imported for it


def _find_type_import(module: str, name: str) -> Any:
    """The object that a module imports under a name in `if TYPE_CHECKING`; `Any` without an import.

    The result is a class of the package, or a stand-in for a class of another package, which would
    take long to import.
    """
    if name not in (imports := type_imports(module)):
        return Any
    home, local = imports[name]
    if home.startswith(f"{_PACKAGE}."):
        return getattr(import_module(home), local)
    return getattr(_Outside(home), local) if local else _Outside(home)


@cache
def type_imports(module: str) -> dict[str, tuple[str, str]]:
    """Name -> (module, its name there) of the imports that a module makes for type checkers.

    The name there is "" for a package: `import xarray`.
    """
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    package = getattr(sys.modules[module], "__package__", "")
    homes = dict[str, tuple[str, str]]()
    for node in (n for block in tree.body if isinstance(block, ast.If) for n in block.body):
        if isinstance(node, ast.ImportFrom):
            home = resolve_name("." * node.level + (node.module or ""), package)
            homes |= {a.asname or a.name: (home, a.name) for a in node.names}
        elif isinstance(node, ast.Import):
            homes |= {(n := a.name.partition(".")[0]): (n, "") for a in node.names}
    return homes


class _Outside:
    """A package that is not imported; its attributes stand in for its classes, by their names."""

    def __init__(self, name: str) -> None:
        self._name = name

    def __getattr__(self, name: str) -> Any:
        if not name[:1].isupper():
            return _Outside(f"{self._name}.{name}")
        package = self._name.partition(".")[0]
        return type(name, (), {"__module__": package, "_is_outside": True})


def _allow_default(check: TypeCheck, default: Any) -> TypeCheck:
    """The check, which also accepts the default value of the parameter, whatever its type."""
    if default is inspect.Parameter.empty:
        return check
    return lambda value: None if value is default else check(value)
