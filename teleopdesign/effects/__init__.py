"""The catalogue of physical effects: every file of this folder whose name has no `_` in front.

An effect of a hand or an environment lies in `of_blocks` and has the name of this block as its
`block`. It is used there, and is no candidate of a diagnosis. `BLOCK_EFFECTS` are these effects.

The file name is the effect's name, and the docstring of the file is the effect's page. A user's
file is read by `load_effect`; its effect is used like any other.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping
from dataclasses import fields
from pathlib import Path
from types import ModuleType
from weakref import WeakValueDictionary

from ..base.arguments import check_arguments
from ..base.errors import ModelError, check_name, did_you_mean
from ..base.folders import Shelf
from ..base.frozen import Catalogue
from ..base.recipes import checked_path, laws_of, load_once, run
from ._effect import (
    CONTACT_ROLES,
    FURTHER,
    INERTIA,
    SIGNALS,
    UNEXPLAINED,
    Effect,
    FitSearch,
    Parameter,
    Role,
    State,
    are_alike,
    delayed,
    parameter_symbol,
    sort_by_action,
)
from ._facts import RecordFacts, repeats_within_travel
from ._linear import acts_linearly, is_linear
from ._position import depends_on_position, depends_on_time, period
from ._structure import make_rubbing_structure, make_structure, make_touching_structure

__all__ = [
    "BLOCK_EFFECTS",
    "CONTACT_ROLES",
    "EFFECTS",
    "FURTHER",
    "INERTIA",
    "SIGNALS",
    "UNEXPLAINED",
    "Effect",
    "FitSearch",
    "Parameter",
    "RecordFacts",
    "Role",
    "State",
    "acts_linearly",
    "are_alike",
    "catalogue",
    "delayed",
    "depends_on_position",
    "depends_on_time",
    "find_effect",
    "is_linear",
    "load_effect",
    "make_structure",
    "sort_by_action",
    "parameter_symbol",
    "period",
    "repeats_within_travel",
    "make_rubbing_structure",
    "make_touching_structure",
    "with_block_effects",
]


def load_effect(path: str | Path) -> Effect:
    """Read one effect file; its name becomes the name of the effect.

    An unchanged file returns the same effect again.
    raises ModelError: the file cannot be read or run, defines no EFFECT, or an unsound one, such as
        one that is declared linear and is not

        >>> known = td.effects.catalogue([td.load_effect("end_stop.py")])  # doctest: +SKIP
        >>> wider = td.Model.from_experiment(experiment, known)  # doctest: +SKIP
    """
    path = checked_path(path, "effect", "my_effect.py")
    return _load_effect(path.resolve(), path)


_LOADED: WeakValueDictionary[tuple[Path, str], Effect] = WeakValueDictionary()


def _load_effect(path: Path, written: Path, expected: str = "") -> Effect:
    """The effect of a file.

    written: its path in messages;  expected: digest that it must have; "": any
    raises ModelError: as `load_effect`
    """

    def read(content: bytes) -> Effect:
        effect = _effect_of(_run(content, written), written)
        check_laws(effect, written)
        if effect.linear and not acts_linearly(effect):
            raise ModelError(
                f"{written}: declares linear = True, but its law is not linear in motion, command "
                "and its own states: write linear=False, and its linear form leaves it out"
            )
        return effect

    return load_once(_LOADED, _load_effect, read, path, written, expected)


def _run(content: bytes, path: Path) -> ModuleType:
    try:
        return run(content, path, __name__)
    except ModelError as error:
        for name in (f.name for f in fields(FitSearch)):
            if f"unexpected keyword argument '{name}'" in str(error):
                raise ModelError(
                    f"{path}: Parameter: found {name}=..., expected search=FitSearch({name}=...)"
                ) from error
        raise


#: signal -> roles whose laws may use it; laws of other roles have no such signal along a motion
ONLY_IN = {
    "command": ("actuation",),
    "level": ("friction_shape",),
    "penetration": ("contact", "contact_shape"),
}


def _effect_of(module: ModuleType, path: Path) -> Effect:
    effect = getattr(module, "EFFECT", None)
    if not isinstance(effect, Effect):
        raise ModelError(f"{path}: found no EFFECT = Effect(...)")
    if effect.role == "structure" and (effect.coupling is None or not effect.states):
        raise ModelError(f"{path}: a structure is written EFFECT = make_structure(coupling=...)")
    for name in (*effect.parameters, *effect.states):
        check_name(name, where=f"{path}")
    if both := set(effect.parameters) & set(effect.states):
        raise ModelError(f'{path}: "{min(both)}" is a parameter and a state: call one otherwise')
    for name in effect.absent:
        if name not in effect.parameters:
            raise ModelError(f'{path}: absent: no parameter "{name}"')
    for i, (name, parameter) in enumerate(effect.parameters.items()):
        if (other := parameter.search.of) and other not in list(effect.parameters)[:i]:
            raise ModelError(
                f'{path}: {name}: FitSearch(of="{other}"): expected a parameter before {name}'
            )
    return effect.named(path.stem, module.__doc__ or "")


def check_laws(effect: Effect, path: Path) -> None:
    """Whether the laws use only signals and parameters that they may use.

    The tests check the effects of the package: it takes 0.15 s, and their files do not change.

    raises ModelError: a law uses another symbol, or cannot be evaluated
    """
    with laws_of(path, effect.parameters):
        allowed = {*SIGNALS.values(), *effect.symbols().values(), *effect.state_symbols().values()}
        needed = tuple(f"{name}_" for name in effect.needs)
        for law in (effect.expression(), *effect.rates().values()):
            known = {s for s in law.free_symbols if s.name.startswith(needed)}
            if strangers := law.free_symbols - allowed - known:
                raise ModelError(f"{path}: law uses {', '.join(map(str, strangers))}")
            for signal, roles in ONLY_IN.items():
                if effect.role not in roles and law.has(SIGNALS[signal]):
                    raise ModelError(
                        f"{path}: law uses now.{signal}, which only the role "
                        f"{' or '.join(roles)} knows; this one is {effect.role}"
                    )
        for law in effect.corrections().values():
            if strangers := law.free_symbols - allowed - {INERTIA, UNEXPLAINED}:
                raise ModelError(f"{path}: correction uses {', '.join(map(str, strangers))}")


def _shipped_effect(module: ModuleType) -> Effect:
    return _effect_of(module, Path(str(module.__file__)))


#: effects of a body or its actuation, and of contacts: the candidates of a diagnosis
EFFECTS: Mapping[str, Effect] = Shelf(
    __name__, Path(__file__).parent, _shipped_effect, "effect", see=" (see `teleopdesign effects`)"
)
#: effects that belong to a hand or an environment
BLOCK_EFFECTS: Mapping[str, Effect] = Shelf(
    f"{__name__}.of_blocks",
    Path(__file__).parent / "of_blocks",
    _shipped_effect,
    "effect of a block",
    defined_in=__name__,
)


def with_block_effects(effects: Mapping[str, Effect] | None = None) -> Mapping[str, Effect]:
    """These effects (None: `EFFECTS`) and those of blocks such as "environment", by name.

    Of two effects with one name, the one in `effects` is used.
    """
    return ChainMap(EFFECTS if effects is None else effects, BLOCK_EFFECTS)  # type: ignore[arg-type]  # only read


def catalogue(extra: Iterable[str | Path | Effect] = ()) -> Mapping[str, Effect]:
    """Effects by name: those of the package, and files or effects of the user.

    extra: paths of effect files, or effects; of two effects with one name, the user's is used
    raises ModelError: as `load_effect`
    """
    users = (e if isinstance(e, Effect) else load_effect(e) for e in extra)
    return Catalogue({**EFFECTS, **{e.name: e for e in users}}, "effect")


#: other name of an effect in the literature -> its name here
OTHER_NAMES: Mapping[str, str] = {
    "stiction": "stribeck",
    "static_friction": "stribeck",
    "breakaway": "stribeck",
    "dry_friction": "coulomb",
    "kinetic_friction": "coulomb",
    "damping": "viscous",
    "damper": "viscous",
    "lugre": "presliding",
    "dahl": "presliding",
    "hysteresis": "presliding",
    "drag": "quadratic_drag",
    "delay": "actuation_delay",
    "dead_time": "actuation_delay",
    "latency": "actuation_delay",
    "lag": "actuator_lag",
    "saturation": "actuator_saturation",
    "play": "backlash",
    "flexibility": "transmission_compliance",
    "elasticity": "transmission_compliance",
    "compliance": "transmission_compliance",
    "counterweight": "bias",
    "offset": "bias",
    "mass": "added_inertia",
    "payload": "added_inertia",
    "warm_up": "friction_drift",
    "temperature": "friction_drift",
    "detent": "cogging",
}


def find_effect(name: str, known: Mapping[str, Effect] = EFFECTS, where: str = "effect") -> Effect:
    """An effect by its name, among the known ones.

    where: first words of a message
    raises ModelError: there is no such effect; the message names the nearest one
    """
    if name not in known:
        meant = OTHER_NAMES.get(name.lower().replace(" ", "_"))
        hint = f'; did you mean "{meant}"?' if meant in known else did_you_mean(name, known)
        raise ModelError(f'{where}: no effect "{name}"{hint} (see `teleopdesign effects`)')
    return known[name]


check_arguments(globals(), __all__)
