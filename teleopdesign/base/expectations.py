"""Checks of a value against an annotation; a check says in words what is wrong with the value."""

from __future__ import annotations

import math
import types
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from .errors import did_you_mean, quote
from .sentences import join_names

_LONGEST = 60  # characters of a value that a message repeats


@dataclass(frozen=True)
class WrongValue:
    """A value that fails a check.

    place: where it stands within the argument, such as '["x"]'
    value: the wrong value
    expected: words for what was expected
    hint: end of the message with the nearest match, or ""
    """

    place: str
    value: Any
    expected: str
    hint: str = ""


#: a function: a value -> the mistake in it, or None
TypeCheck = Callable[[Any], WrongValue | None]


def describe_value(value: Any) -> str:
    """A value in words: 'the number 0.15', 'the text "C"', 'a Body'."""
    if value is None or isinstance(value, bool):
        return str(value)
    if isinstance(value, str):
        return f"the text {quote(value)}"
    if isinstance(value, type):
        return f"the class {value.__name__}"
    if isinstance(value, int | float | complex):
        return f"the number {value!r}"
    if isinstance(value, types.FunctionType | types.BuiltinFunctionType | types.MethodType):
        return f"the function {value.__name__}"
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        return f"an array of shape {tuple(value.shape)}" if value.shape else f"the number {value}"
    if isinstance(value, dict | list | tuple | set):
        text = repr(value) if len(value) < 9 else ""
        plain = text and len(text) <= _LONGEST and "\n" not in text
        return f"the {type(value).__name__} {text}" if plain else with_article(type(value).__name__)
    return with_article(type(value).__name__)


def with_article(name: str) -> str:
    return f"{'an' if name[:1].lower() in 'aeiou' else 'a'} {name}"


def check_of(annotation: Any) -> TypeCheck | None:
    """The check for a resolved annotation; None if the annotation accepts every value."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if annotation is Any or annotation is object or isinstance(annotation, TypeVar | str):
        return None
    if annotation is None or annotation is type(None):
        return _make_check("None", lambda v: v is None)
    if annotation in _SIMPLE:
        return _SIMPLE[annotation]
    if origin is Annotated:
        return check_of(inner[0])
    if origin is Literal:
        return _one_of(inner)
    if origin in (Union, types.UnionType):
        return _make_any_check(inner)
    if origin in (Mapping, dict):
        return _make_mapping_check(*inner)
    if origin is tuple and not (len(inner) == 2 and inner[1] is Ellipsis):
        return _make_tuple_check(inner)
    if origin in (tuple, list, set, frozenset, Sequence, Collection, Iterable):
        return _several(origin, inner[0])
    if annotation is Callable or origin is Callable:
        return _make_check("a function", callable)
    kind = origin or annotation
    if not isinstance(kind, type) or getattr(kind, "_is_protocol", False):
        return None
    return _make_class_check(kind)


def _make_check(expected: str, accepts: Callable[[Any], bool]) -> TypeCheck:
    return lambda value: None if accepts(value) else WrongValue("", value, expected)


def _is_real_number(value: Any) -> bool:
    """Whether a value is a real number of Python, numpy or sympy; truth values are not."""
    if isinstance(value, bool | str | bytes) or value is None:
        return False
    if isinstance(value, int | float):
        return True
    if hasattr(value, "dtype"):
        return getattr(value, "shape", None) == () and value.dtype.kind in "iuf"
    if hasattr(value, "is_number"):  # of sympy
        return bool(value.is_number and value.is_extended_real)
    return hasattr(value, "__float__") and not hasattr(value, "__len__")


def number_check(value: Any) -> WrongValue | None:
    """The check for a finite or infinite number; quick for floats, the most frequent case."""
    if type(value) is float and value == value:
        return None
    if not _is_real_number(value):
        return WrongValue("", value, "a number (SI)")
    return WrongValue("", value, "a number (SI), not NaN") if math.isnan(float(value)) else None


def _check_whole(value: Any) -> WrongValue | None:
    whole = _is_real_number(value) and hasattr(value, "__index__")
    return None if whole else WrongValue("", value, "a whole number")


def _truth(value: Any) -> WrongValue | None:
    is_truth = isinstance(value, bool) or getattr(getattr(value, "dtype", None), "kind", "") == "b"
    return None if is_truth else WrongValue("", value, "True or False")


def _complex(value: Any) -> WrongValue | None:
    is_complex = (
        isinstance(value, complex) or getattr(getattr(value, "dtype", None), "kind", "") == "c"
    )
    return None if is_complex or _is_real_number(value) else WrongValue("", value, "a number")


_SIMPLE: dict[Any, TypeCheck] = {
    float: number_check,
    int: _check_whole,
    bool: _truth,
    complex: _complex,
    str: _make_check("a text", lambda v: isinstance(v, str)),
}


def _one_of(values: tuple[Any, ...]) -> TypeCheck:
    names = [v for v in values if isinstance(v, str)]
    words = [f'"{v}"' if isinstance(v, str) else str(v) for v in values]
    listed = " or ".join(words) if len(words) < 4 else f"one of {', '.join(words)}"

    def check(value: Any) -> WrongValue | None:
        if any(value is v or (type(value) is type(v) and value == v) for v in values):
            return None
        hint = did_you_mean(value, names) if isinstance(value, str) else ""
        return WrongValue("", value, listed, hint)

    return check


def _make_any_check(parts: tuple[Any, ...]) -> TypeCheck | None:
    checks = [check_of(part) for part in parts]
    if any(c is None for c in checks):
        return None
    whole = [c for c in checks if c is not None]

    def check(value: Any) -> WrongValue | None:
        wrong = []
        for one in whole:
            refusal = one(value)
            if refusal is None:
                return None
            wrong.append(refusal)
        # a mistake within a mapping or sequence says more than that the whole is of no kind
        deeper = [w for w in wrong if w.place]
        if deeper:
            return deeper[0]
        words = [w for w in dict.fromkeys(w.expected for w in wrong) if w != "None"]
        hints = [w.hint for w in wrong if w.hint]
        if "a Controller" in words and type(value).__module__.startswith("control."):
            hints.append(": td.from_control(system) makes a controller of it")
        return WrongValue("", value, join_names(words, "or"), *hints[:1])

    return check


def _first_mistake(parts: Iterable[tuple[str, TypeCheck | None, Any]]) -> WrongValue | None:
    """The first mistake among parts of a value: (place, check, part)."""
    for place, check, part in parts:
        if check is not None and (wrong := check(part)) is not None:
            return replace(wrong, place=f"{place}{wrong.place}")
    return None


def _make_mapping_check(key: Any, content: Any) -> TypeCheck:
    of_key, of_content = check_of(key), check_of(content)

    def check(value: Any) -> WrongValue | None:
        if not isinstance(value, Mapping):
            return WrongValue("", value, 'a mapping, such as {"name": ...}')
        keys = _first_mistake((": key", of_key, name) for name in value)
        return keys or _first_mistake((f'["{n}"]', of_content, v) for n, v in value.items())

    return check


def _several(kind: Any, content: Any) -> TypeCheck:
    of_content = check_of(content)
    words = {tuple: "a tuple", list: "a list", frozenset: "a frozenset", set: "a set"}
    expected = words.get(kind, "several, as a tuple or list")

    def check(value: Any) -> WrongValue | None:
        if isinstance(value, str | bytes) or not _is_container(value, kind):
            return WrongValue("", value, expected)
        if of_content is None or not isinstance(value, Collection):
            return None
        return _first_mistake((f"[{i}]", of_content, part) for i, part in enumerate(value))

    return check


def _is_container(value: Any, kind: Any) -> bool:
    if kind is Sequence and hasattr(value, "dtype"):  # an array is one, whatever its class says
        return bool(getattr(value, "shape", ()))
    return isinstance(value, kind)


def _make_tuple_check(parts: tuple[Any, ...]) -> TypeCheck:
    checks = [check_of(part) for part in parts]

    def check(value: Any) -> WrongValue | None:
        if not isinstance(value, tuple | list) or len(value) != len(parts):
            return WrongValue("", value, f"a tuple of {len(parts)}")
        pairs = enumerate(zip(checks, value, strict=True))
        return _first_mistake((f"[{i}]", one, part) for i, (one, part) in pairs)

    return check


def _make_class_check(kind: type[Any]) -> TypeCheck:
    name = kind.__name__
    if name == "ndarray":
        return _make_check("an array of numbers", _is_array)
    if name == "Expr":
        return _make_check("an expression of sympy", lambda v: isinstance(v, kind))
    if hasattr(kind, "_is_outside"):
        package = {"control": "python-control"}.get(kind.__module__, kind.__module__)
        expected = f"{with_article(name)} of {package}"
        return _make_check(expected, lambda v: _is_from_outside(v, kind))
    expected = "a path" if name in ("Path", "PurePath") else with_article(name)
    expected = "ANY" if name == "AnyBlock" else expected
    return _make_check(expected, lambda v: isinstance(v, kind))


def _is_from_outside(value: Any, kind: type[Any]) -> bool:
    names = ((c.__module__.partition(".")[0], c.__name__) for c in type(value).__mro__)
    return (kind.__module__, kind.__name__) in names


def _is_array(value: Any) -> bool:
    return (
        hasattr(value, "__array__")
        and hasattr(value, "shape")
        and (value.dtype.kind in "iufc")
        and bool(value.shape)
    )
