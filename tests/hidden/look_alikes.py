"""Effects that one record cannot tell apart: twins by construction, others by a re-estimate."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from machines import Machine
from truth_effects import CONTACT, NEEDS_LEVEL, NO_INVERSE, OTHERS, REVOLUTE, TEN, Values, draw

if TYPE_CHECKING:
    from cases import Hidden

TWINS = {"bias": "coulomb_asymmetry", "coulomb_asymmetry": "bias"}
# effects that one record may not tell apart although others would
FAMILIES = (
    {"actuation_delay", "actuator_lag"}, {"spring", "hardening_spring"}, {"stribeck", "presliding"},
    {"viscous", "quadratic_drag", "load_dependent_friction"},
    {"shear_thinning", "viscous", "coulomb", "actuator_saturation", "load_dependent_friction"},
    {"actuator_gain", "actuator_saturation"}, {"gravity", "bias"}, {"gravity", "spring"},
)  # fmt: skip
PERIODIC = {"cogging", "torque_ripple", "position_dependent_friction"}
# check error with effects added to the model of each body, after so many steps of the re-estimate
Error = Callable[[list[Values], list[list[str]], int], float]


def groups(
    machine: Machine,
    hidden: list[Hidden],
    values: list[Values],
    *,
    error: Error,
    true: float,
    excitation: str,
) -> list[list[dict[str, str]]]:
    """The true effects that have look-alikes, each followed by these.

    Beside twins: single effects that, re-estimated in place of the true one, leave no more on the
    check record than noise makes of the right model (`true`, less 5 %). Tried are those of the same
    family; after a poor excitation all that a local search of the reference finds: not the periodic
    ones, and none with a state that the reference does not know.
    """
    out = []
    for h in hidden:
        alike = [TWINS[h.effect]] if h.effect in TWINS else []
        if len(hidden) == 1:
            alike += [
                e
                for e in _others(machine, h, excitation)
                if _explains(e, h, machine, values, error, true)
            ]
        if alike:
            out.append([{"effect": e, "at": h.at} for e in (h.effect, *alike)])
    return out


def _others(machine: Machine, hidden: Hidden, excitation: str) -> list[str]:
    """Effects that could stand in for a hidden one at its place."""
    if hidden.at == "environment":
        return [e for e in CONTACT if e != hidden.effect]
    model = machine.in_model[hidden.body]
    skip = {hidden.effect, *model, *NO_INVERSE, *PERIODIC, TWINS.get(hidden.effect)}
    if machine.axis == "prismatic":
        skip |= REVOLUTE
    if "coulomb" not in model:
        skip |= NEEDS_LEVEL
    if not machine.fixed_inertia[hidden.body]:
        skip.add("added_inertia")
    if not machine.sensors[hidden.body]:
        skip.add("actuator_gain")  # nothing else sets the scale of force: it would fit anything
    near = {e for family in FAMILIES if hidden.effect in family for e in family}
    return [e for e in (*TEN, *OTHERS) if e not in skip and (excitation == "poor" or e in near)]


def _explains(
    other: str,
    hidden: Hidden,
    machine: Machine,
    values: list[Values],
    error: Error,
    true: float,
) -> bool:
    """Whether another effect at the same place leaves as little as the right model does."""
    i = hidden.body
    middle = dict.fromkeys("abcd", 0.5) | {"sign": 1.0}
    changed = [dict(v) for v in values]
    changed[i] |= draw(other, values[i], machine.scales[i], hidden.strength, middle)
    added: list[list[str]] = [[] for _ in values]
    added[i].append(other)
    # most are far off after a few steps already
    return all(
        error(changed, added, steps) < limit * true for steps, limit in ((3, 2.0), (8, 1.05))
    )
