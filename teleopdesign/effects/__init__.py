"""The catalogue of physical effects: every file of this folder that does not begin with `_`.

The file name is the effect's name, its docstring the effect's page. A user's own file is read by
`load_effect` and takes part like any other.
"""

from __future__ import annotations

import importlib.util
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType, ModuleType

from ..errors import ModelError, did_you_mean
from ._effect import (
    CONTACT_ROLES,
    ENERGIES,
    INERTIA,
    ROLES,
    SIGNALS,
    UNEXPLAINED,
    Effect,
    Parameter,
    Role,
    State,
    delayed,
    ordered,
)

__all__ = [
    "CONTACT_ROLES",
    "EFFECTS",
    "INERTIA",
    "SIGNALS",
    "UNEXPLAINED",
    "Effect",
    "Parameter",
    "Role",
    "State",
    "catalogue",
    "delayed",
    "find_effect",
    "load_effect",
    "ordered",
]


def load_effect(path: str | Path) -> Effect:
    """Read one effect file; the name of the file becomes the name of the effect.

    raises ModelError: the file cannot be read or run, defines no EFFECT, or an unsound one
    """
    path = Path(path)
    if not path.is_file():
        raise ModelError(f"{path}: no such effect file")
    if not path.stem.isidentifier():
        raise ModelError(f'{path}: the file name "{path.stem}" must be a name such as my_effect.py')
    spec = importlib.util.spec_from_file_location(f"{__name__}.{path.stem}", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except Exception as error:  # any failure of a user's file is reported, with its kind
        raise ModelError(f"{path}: {type(error).__name__}: {error}") from error
    return _checked(module, path)


def _checked(module: ModuleType, path: Path) -> Effect:
    effect = getattr(module, "EFFECT", None)
    if not isinstance(effect, Effect):
        raise ModelError(f"{path}: found no EFFECT = Effect(...)")
    if effect.role not in ROLES:
        raise ModelError(
            f'{path}: role "{effect.role}" is none of {", ".join(ROLES)}'
            f"{did_you_mean(effect.role, ROLES)}"
        )
    if effect.energy not in ENERGIES:
        raise ModelError(
            f'{path}: energy "{effect.energy}" is none of {", ".join(ENERGIES)}'
            f"{did_you_mean(effect.energy, ENERGIES)}"
        )
    for name in effect.absent:
        if name not in effect.parameters:
            raise ModelError(f'{path}: absent: no parameter "{name}"')
    effect = effect.named(path.stem, module.__doc__ or "")
    try:
        allowed = {*SIGNALS.values(), *effect.symbols().values(), *effect.state_symbols().values()}
        for law in (effect.expression(), *effect.rates().values()):
            if strangers := law.free_symbols - allowed:
                raise ModelError(f"{path}: law uses {', '.join(map(str, strangers))}")
        for law in effect.corrections().values():
            if strangers := law.free_symbols - allowed - {INERTIA, UNEXPLAINED}:
                raise ModelError(f"{path}: correction uses {', '.join(map(str, strangers))}")
    except (AttributeError, TypeError) as error:
        raise ModelError(f"{path}: law: {error}") from error
    return effect


def _own_effects() -> Mapping[str, Effect]:
    files = sorted(p for p in Path(__file__).parent.glob("*.py") if not p.name.startswith("_"))
    return MappingProxyType({p.stem: load_effect(p) for p in files})


EFFECTS: Mapping[str, Effect] = _own_effects()


def catalogue(extra: Iterable[str | Path | Effect] = ()) -> Mapping[str, Effect]:
    """The package's effects and the given files' (or effects), by name; a user's name wins."""
    own = (e if isinstance(e, Effect) else load_effect(e) for e in extra)
    return MappingProxyType({**EFFECTS, **{e.name: e for e in own}})


def find_effect(name: str, known: Mapping[str, Effect] = EFFECTS, where: str = "effect") -> Effect:
    """The effect of that name; raises ModelError with the nearest known name."""
    if name not in known:
        raise ModelError(
            f'{where}: no effect "{name}"{did_you_mean(name, known)} (see `teleopdesign effects`)'
        )
    return known[name]
