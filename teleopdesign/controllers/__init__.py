"""Control laws, chosen by the user. Every file that does not begin with `_` holds one law.

controller("smoothed_coulomb", {"level": 0.5, "smoothing_velocity": 0.015})
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from types import ModuleType
from typing import Literal
from weakref import WeakValueDictionary

from ..base.arguments import check_arguments
from ..base.errors import ModelError, check_name, unknown
from ..base.folders import Shelf
from ..base.frozen import Catalogue
from ..base.recipes import checked_path, laws_of, load_once, run
from ._controller import (
    SIGNALS,
    Ability,
    ControlLaw,
    Controller,
    ControllerEquation,
    ControllerState,
    Stage,
    parameter_symbol,
)
from ._declarations import (
    broken_declarations,
    equation_of,
    has_shape,
    require_exact_steps,
    require_kept,
    symbols_of,
    unknown_symbols,
)
from ._exact import exact_decimal, make_exact, resolvent, unseen_factor
from ._from_control import (
    from_control,
    invert_plant,
    matrices_of,
    measured_frequencies,
    measured_plant,
    unit_state,
)
from ._of_effects import CANCEL, cancel, cancelling_law, why_not_cancelled
from ._opaque import calls_in, is_call, opaque_laws
from ._state_space import is_of_matrices, sides_of

__all__ = [
    "CANCEL",
    "CONTROLLERS",
    "SIGNALS",
    "Ability",
    "ControlLaw",
    "Controller",
    "ControllerEquation",
    "ControllerState",
    "Stage",
    "exact_decimal",
    "broken_declarations",
    "calls_in",
    "cancel",
    "cancelling_law",
    "catalogue",
    "controller",
    "equation_of",
    "from_control",
    "has_shape",
    "make_exact",
    "invert_plant",
    "is_call",
    "laws_that_declare",
    "load_controller",
    "matrices_of",
    "is_of_matrices",
    "sides_of",
    "measured_frequencies",
    "measured_plant",
    "opaque_laws",
    "parameter_symbol",
    "resolvent",
    "scheduled_force_feedback",
    "require_exact_steps",
    "require_kept",
    "symbols_of",
    "unit_state",
    "unseen_factor",
    "why_not_cancelled",
]


def _shipped_law(module: ModuleType) -> ControlLaw:
    law: ControlLaw = module.CONTROLLER
    return law.named(module.__name__.rpartition(".")[2], module.__doc__ or "")


CONTROLLERS: Mapping[str, ControlLaw] = Shelf(
    __name__, Path(__file__).parent, _shipped_law, "control law"
)


def catalogue(extra: Iterable[str | Path | ControlLaw] = ()) -> Mapping[str, ControlLaw]:
    """Control laws by name: those of the package, and files or laws of the user.

    extra: paths of files, or laws that `load_controller` returned; of two laws with one name, the
        user's is used
    raises ModelError: as `load_controller`; a law without a name
    """
    users = [law if isinstance(law, ControlLaw) else load_controller(law) for law in extra]
    if any(not law.name for law in users):
        raise ModelError("catalogue: found a law without a name: give it one, ControlLaw(name=...)")
    return Catalogue({**CONTROLLERS, **{law.name: law for law in users}}, "control law")


def controller(name: str | ControlLaw, values: Mapping[str, float]) -> Controller:
    """A control law with these parameter values (SI).

    name: of a law of the catalogue, "cancel" with parameters of effects such as
        "cogging.amplitude" (as `cancel`), or a user's law (`load_controller`)
    raises ModelError: no such law, or a value that is missing, unknown or out of bounds

        >>> td.controller("dahl", {"level": 1.0, "stiffness": 1e4})
        Controller dahl(level = 1, stiffness = 10000)
    """
    if isinstance(name, ControlLaw):
        return Controller((Stage(name, values),))
    if name == CANCEL:
        return Controller((Stage(cancelling_law(tuple(values)), values),))
    if name not in CONTROLLERS:
        raise ModelError(f"controller: {unknown('law', name, CONTROLLERS)}")
    return Controller((Stage(CONTROLLERS[name], values),))


def laws_that_declare(ability: Ability) -> tuple[ControlLaw, ...]:
    """Control laws of the catalogue that declare an ability, sorted by name.

    ability: such as "bound": the law states its largest force
    """
    return tuple(law for law in CONTROLLERS.values() if getattr(law, ability))


def scheduled_force_feedback(
    *,
    gain: float,
    scheduling_velocity: float,
    bandwidth: float,
    schedule: Literal["before", "after"] = "before",
) -> Controller:
    """Block H: low-pass of the force error with a gain k b/(b + abs(v)).

    gain: k at rest, 1;  scheduling_velocity: b in m/s;  bandwidth: of the low-pass, Hz
    schedule: whether the gain acts "before" or "after" the filter; both differ if abs(v) changes
        within the time constant of the filter. The paper does not state it.
    """
    if schedule not in ("before", "after"):
        raise ModelError(f'schedule: expected "before" or "after", found "{schedule}"')
    values = {"gain": gain, "scheduling_velocity": scheduling_velocity}
    scheduled = controller("velocity_schedule", values)
    low_pass = controller("low_pass", {"bandwidth": bandwidth})
    return scheduled.then(low_pass) if schedule == "before" else low_pass.then(scheduled)


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


check_arguments(globals(), __all__)
