"""Strengths that differ from the model's by factors: a unit stated as another, a scale, a guess."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ..base.finding import Finding
from ..base.units import unit_of
from ..blocks import Body
from ..check import CheckedRecording
from ..measurement.first_guess import is_first_guess
from ._force_balance import ForceBalance

#: a gain or an inertia that is wrong by more than this factor is in another unit; by less it may be
#: a calibration or a poor first value
FAR = 10.0
#: decades by which strengths may differ from those of a slip of units: a user's values are guesses
NEAR = 0.5
#: the same for a device's known values, where the slip is below `FAR`: first values are commonly
#: 20 % off, and turns are 0.8 decades off radians
CLEAR = 0.2
#: ratios whose logarithms differ by up to ONE_SCALE are one scale. A factor below OFF_SCALE is not
#: reported, because a user's first values are commonly 20 % off
ONE_SCALE, OFF_SCALE = 0.15, 2.0
#: power of (force, position) in each quantity's unit
POWERS = {
    "force": (1, 0),
    "inertia": (1, -1),
    "damping": (1, -1),
    "stiffness": (1, -1),
    "drag": (1, -2),
    "cubic_stiffness": (1, -3),
}
#: axis -> what may be in which unit where it is given in SI, and its factor on the numbers
_SLIPS = {
    "prismatic": (
        ("position", "mm", 1e3),
        ("position", "cm", 1e2),
        ("position", "km", 1e-3),
        ("force", "mN", 1e3),
        ("force", "kN", 1e-3),
        ("inertia", "g", 1e-3),
    ),
    "revolute": (
        ("position", "deg", 180 / math.pi),
        ("position", "mrad", 1e3),
        ("position", "turns", 1 / (2 * math.pi)),
        ("force", "N*mm", 1e3),
        ("force", "kN*m", 1e-3),
        ("inertia", "kg*cm^2", 1e-4),
        ("inertia", "g*cm^2", 1e-7),
        ("inertia", "g*m^2", 1e-3),
    ),
}
#: what is in another unit, in words, and where the unit stands
_PLACES = {
    "position": ("the position is", "channels.position"),
    "force": ("the forces are", "channels.actuator_force"),
    "inertia": ("the model's inertia is meant", "the inertia"),
}


def check_strengths(recording: CheckedRecording, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on strengths that differ far from the model's: a unit, a scale, a poor guess."""
    body = recording.compared[0].body(balance.body)
    ratios = {
        name: estimate.value / stated
        for name, estimate in balance.strengths.items()
        if (stated := body.parameters[name].value) > 0
        and estimate.sure > 0
        and body.parameter(name).quantity in POWERS
    }
    # nobody states what these records gave as a first value
    inertia, records = body.parameters["inertia"], recording.experiment.fit_records
    if not inertia.fixed and is_first_guess(records, balance.body, inertia.value):
        yield from _poor_guess(body, balance, {"inertia": ratios.get("inertia", 1.0)})
        return
    if 1 / FAR < ratios.get("inertia", 1.0) < FAR:
        yield from tuple(_force_scale(balance, ratios)) or _poor_guess(body, balance, ratios)
        return
    causes = slips(body, ratios) or _scale_of_forces(ratios)
    strengths = ", ".join(
        f"{n} {balance.strengths[n].value:.3g} {body.unit(n)} where the model states "
        f"{body.parameters[n].value:.3g} {body.unit(n)}"
        for n in ratios
    )
    why = " or ".join(causes) if causes else "a unit, or a guess that is far off"
    sentence = f"the motion requires {strengths}: {why}."
    yield Finding("units", "warning", sentence, _numbers(ratios), balance.body)


def _force_scale(balance: ForceBalance, ratios: Mapping[str, float]) -> Iterator[Finding]:
    """A finding on strengths that all differ by one factor: the scale of the forces is wrong."""
    if len(ratios) < 2:
        return
    factor = math.exp(sum(math.log(v) for v in ratios.values()) / len(ratios))
    spread = max(abs(math.log(v / factor)) for v in ratios.values())
    if spread > ONE_SCALE or abs(math.log(factor)) < math.log(OFF_SCALE):
        return
    sentence = (
        f"the motion requires {factor:.3g} times the model's {', '.join(ratios)}, all alike: where "
        f"these are known, the forces are {factor:.3g} times too large, as by a torque constant or "
        f"a gear ratio; write scale = {1 / factor:.4g} at channels.actuator_force."
    )
    yield Finding("units", "note", sentence, {"factor": factor, "spread": spread}, balance.body)


def _poor_guess(
    body: Body, balance: ForceBalance, ratios: Mapping[str, float]
) -> Iterator[Finding]:
    """A finding on an inertia several times the model's, which may be a poor first value."""
    inertia = ratios.get("inertia", 1.0)
    if 1 / OFF_SCALE < inertia < OFF_SCALE:
        return
    known = {n: r for n, r in ratios.items() if n in ("inertia", "coulomb.level")}
    causes = slips(body, known, near=CLEAR) if len(known) > 1 else []
    why = " or ".join([*causes, "the first value is a guess", "the scale of the forces is off"])
    unit, moved = body.unit("inertia"), balance.strengths["inertia"].value
    sentence = (
        f"the motion requires an inertia of {moved:.3g} {unit}, {inertia:.2g} times the model's "
        f"{body.parameters['inertia'].value:.3g} {unit}: {why}."
    )
    yield Finding("units", "note", sentence, _numbers(ratios), balance.body)


def _numbers(ratios: Mapping[str, float]) -> dict[str, float]:
    return {f"ratio.{n}": r for n, r in ratios.items()}


def slips(body: Body, ratios: Mapping[str, float], *, near: float = NEAR) -> list[str]:
    """The slips of units that bring every strength near the model's, best first, in words.

    ratios: strength -> estimated over stated value;  near: decades that count as near
    """
    powers = {n: POWERS[body.parameter(n).quantity] for n in ratios}
    worst: dict[str, float] = {}
    for what, unit, factor in _SLIPS[body.axis]:
        expected = {n: factor if n == "inertia" else 1.0 for n in ratios}
        if what != "inertia":
            of = 1 if what == "position" else 0
            expected = {n: factor ** power[of] for n, power in powers.items()}
        words, place = _PLACES[what]
        stated = unit_of(what, body.axis)
        text = f'{words} in {unit}, given as {stated} (write unit = "{unit}" at {place})'
        worst[text] = max(abs(math.log10(ratios[n] / expected[n])) for n in ratios)
    likely = [t for t in sorted(worst, key=lambda t: worst[t]) if worst[t] < near]
    return [t for t in likely if worst[t] < worst[likely[0]] + 0.1]


def _scale_of_forces(ratios: Mapping[str, float]) -> list[str]:
    """A sentence that all strengths differ from the model's by one factor; else empty."""
    if len(ratios) < 2:
        return []
    factor = 10 ** (sum(math.log10(r) for r in ratios.values()) / len(ratios))
    if max(abs(math.log10(r / factor)) for r in ratios.values()) > NEAR:
        return []
    return [
        f"the forces are about {factor:.1g} times what the model requires, as by a torque constant "
        "or a gear ratio"
    ]
