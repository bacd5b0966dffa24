"""Do forces, motion and model agree in sign, unit and time? Plain findings from `force_balance`.

The findings come from one linear fit to the rows in motion. A warning is issued where the user's
columns, as labelled, contradict each other by far more than an effect could.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from ..base.finding import Finding
from ..base.sentences import with_standard_error
from ..base.units import unit_of
from ..diagnose.feedback_law import describe_computed
from ..diagnose.prepare import Prepared
from ..model import Model
from .force_balance import ForceBalance, force_balances
from .late_channels import check_lateness, is_without_hand, label_of
from .swapped_columns import check_swapped
from .unit_slips import NEAR, POWERS, scale_of_forces, slips

#: a gain or an inertia that is wrong by more than this factor is in another unit; by less it may be
#: a calibration or a poor first value
FAR = 10.0
#: a gain between 1/CALIBRATED and CALIBRATED is the calibration of a force sensor and needs no
#: note. A gain with a relative standard error above UNSURE is not known
CALIBRATED, UNSURE = 1.25, 0.05
#: ratios whose logarithms differ by up to ONE_SCALE are one scale. A factor below OFF_SCALE is not
#: reported, because a user's first values are commonly 20 % off
ONE_SCALE, OFF_SCALE = 0.15, 2.0
#: decades by which a device's known values may differ from those of a slip of units, where the slip
#: is below `FAR`: first values are commonly 20 % off, and turns are 0.8 decades off radians
CLEAR = 0.2
#: part of the force that is left unexplained, above which there is no finding on signs, units,
#: shifts
NOTHING = 0.9


def check_plausibility(model: Model, prepared: Prepared) -> tuple[Finding, ...]:
    """Findings on sign, unit and timing of the channels of every body."""
    balances = force_balances(model, prepared)
    swapped = list(check_swapped(model, prepared, balances))
    if swapped:
        return tuple(swapped)
    findings: list[Finding] = []
    for place, balance in balances.items():
        doubts = [*_signs(prepared, balance), *_gain(model, prepared, balance)]
        if not doubts:
            doubts = [*_units(model, balance), *check_lateness(model, prepared, balance)]
        findings += doubts or [_report_agreement(model, place, balance)]
        findings += _calibration(prepared, balance)
    return tuple(findings)


def _signs(prepared: Prepared, balance: ForceBalance) -> Iterator[Finding]:
    """A finding where friction drives or inertia is negative: a channel has the wrong sign."""
    inertia = balance.strengths["inertia"]
    braking = max(
        (p for n, p in balance.power.items() if n != "inertia"),
        key=lambda p: abs(p.value),
        default=None,
    )
    brakes = 0 if braking is None else braking.sure
    against = balance.gain.sure < 0
    turned = inertia.sure < 0 and brakes <= 0 or inertia.sure == 0 and brakes < 0
    if balance.left > NOTHING or not (against or turned):
        return
    if describe_computed(prepared.experiment, balance.body):
        return  # the spring and the damper of a controller, against which a hand moves the device
    lead, other = (label_of(prepared, balance.body, q) for q in (balance.lead, balance.other or ""))
    if against:
        wrong = lead if turned else other
    elif balance.other:
        wrong = label_of(prepared, balance.body, "position")
    else:
        wrong = f"{lead} or {label_of(prepared, balance.body, 'position')}"
    unit = unit_of("inertia", prepared.experiment.axis(balance.body))
    drives = f" and friction drives with {-braking.value:.3g} W" if braking and brakes < 0 else ""
    evidence = f"the inertia is {inertia.value:.3g} {unit}{drives}"
    if against and not turned:
        evidence = f"the force that balances {lead} is {balance.gain.value:.3g} times it"
    looks = " A hand that moves the device and is not logged looks the same."
    hand = looks if is_without_hand(prepared, balance) else ""
    yield Finding(
        "signs",
        "warning",
        f"{wrong} has the opposite sign: as recorded, {evidence}. All forces on a body and its "
        f"position are positive the same way.{hand}",
        {
            "gain": balance.gain.value,
            "inertia": inertia.value,
            "power": float("nan") if braking is None else braking.value,
        },
        balance.body,
    )


def _gain(model: Model, prepared: Prepared, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on a second force whose scale is far from that of the first: a wrong unit."""
    gain = balance.gain
    if not balance.other or balance.left > NOTHING or gain.sure <= 0:
        return
    if 1 / FAR < gain.value < FAR:
        return
    lead, other = (label_of(prepared, balance.body, q) for q in (balance.lead, balance.other))
    inertia = model.body(balance.body).parameters["inertia"].value
    ratio = balance.strengths["inertia"].value / inertia if inertia else float("nan")
    wrong = "one of the two is"
    if abs(math.log10(max(ratio, 1e-300))) < NEAR:
        wrong = f"{other} is"
    elif abs(math.log10(max(ratio / gain.value, 1e-300))) < NEAR:
        wrong = f"{lead} is"
    yield Finding(
        "units",
        "warning",
        f"{other} is {1 / gain.value:.3g} times as large as the force that balances {lead}: "
        f"judging by the inertia, {wrong} in another unit than stated.",
        {"gain": gain.value, "error": gain.error, "inertia_ratio": ratio},
        balance.body,
    )


def _calibration(prepared: Prepared, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on a second force whose scale differs from the first by a calibration factor."""
    gain = balance.gain
    if not balance.other or balance.left > NOTHING or gain.error > UNSURE * gain.value:
        return
    if not 1 / FAR < gain.value < FAR or 1 / CALIBRATED < gain.value < CALIBRATED:
        return
    lead, other = (label_of(prepared, balance.body, q) for q in (balance.lead, balance.other))
    yield Finding(
        "force scales",
        "note",
        f"{other} balances {lead} only when multiplied by "
        f"{with_standard_error(gain.value, gain.error)}: the "
        f"scale of one is wrong, such as a torque constant (scale = {gain.value:.4g} at "
        f"channels.{other}, or {1 / gain.value:.4g} times that of channels.{lead}), or the "
        "actuator gives another force than commanded (actuator_gain).",
        {"gain": gain.value, "error": gain.error},
        balance.body,
    )


def _units(model: Model, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on strengths that differ from the model's by the factors of a wrong unit."""
    body = model.body(balance.body)
    ratios: dict[str, float] = {}
    for name, estimate in balance.strengths.items():
        stated = body.parameters[name].value
        known = body.parameter(name).quantity in POWERS
        if estimate.sure > 0 and stated > 0 and known:
            ratios[name] = estimate.value / stated
    inertia = ratios.get("inertia", 1.0)
    if balance.left > NOTHING:
        return
    if 1 / FAR < inertia < FAR:
        scale = tuple(_force_scale(balance, ratios))
        yield from scale or _poor_guess(model, balance, ratios)
        return
    quantities = {n: body.parameter(n).quantity for n in ratios}
    causes = slips(body.axis, ratios, quantities) or scale_of_forces(ratios)
    strengths = ", ".join(
        f"{n} {balance.strengths[n].value:.3g} {body.unit(n)} where the model states "
        f"{body.parameters[n].value:.3g} {body.unit(n)}"
        for n in ratios
    )
    why = " or ".join(causes) if causes else "a unit, or a guess that is far off"
    yield Finding(
        "units",
        "warning",
        f"the motion requires {strengths}: {why}.",
        {f"ratio.{n}": r for n, r in ratios.items()},
        balance.body,
    )


def _force_scale(balance: ForceBalance, ratios: Mapping[str, float]) -> Iterator[Finding]:
    """A finding on strengths that all differ by one factor: the scale of the forces is wrong."""
    if len(ratios) < 2:
        return
    factor = math.exp(sum(math.log(v) for v in ratios.values()) / len(ratios))
    spread = max(abs(math.log(v / factor)) for v in ratios.values())
    if spread > ONE_SCALE or abs(math.log(factor)) < math.log(OFF_SCALE):
        return
    yield Finding(
        "units",
        "note",
        f"the motion requires {factor:.3g} times the model's {', '.join(ratios)}, all alike: where "
        f"these are known, the forces are {factor:.3g} times too large, as by a torque constant or "
        f"a gear ratio; write scale = {1 / factor:.4g} at channels.actuator_force.",
        {"factor": factor, "spread": spread},
        balance.body,
    )


def _poor_guess(
    model: Model, balance: ForceBalance, ratios: Mapping[str, float]
) -> Iterator[Finding]:
    """A finding on an inertia several times the model's, which may be a poor first value."""
    inertia = ratios.get("inertia", 1.0)
    if 1 / OFF_SCALE < inertia < OFF_SCALE:
        return
    body = model.body(balance.body)
    known = {n: r for n, r in ratios.items() if n in ("inertia", "coulomb.level")}
    quantities = {n: body.parameter(n).quantity for n in known}
    causes = slips(body.axis, known, quantities, near=CLEAR) if len(known) > 1 else []
    why = " or ".join([*causes, "the first value is a guess", "the scale of the forces is off"])
    unit, moved = body.unit("inertia"), balance.strengths["inertia"].value
    yield Finding(
        "units",
        "note",
        f"the motion requires an inertia of {moved:.3g} {unit}, {inertia:.2g} times the model's "
        f"{body.parameters['inertia'].value:.3g} {unit}: {why}.",
        {f"ratio.{n}": r for n, r in ratios.items()},
        balance.body,
    )


def _report_agreement(model: Model, place: str, balance: ForceBalance) -> Finding:
    body = model.body(place)
    inertia = balance.strengths["inertia"]
    of_model = body.parameters["inertia"].value
    numbers = {"inertia": inertia.value, "left": balance.left, "gain": balance.gain.value}
    if inertia.sure < 0:
        return Finding(
            "signs and units",
            "note",
            f"the motion requires a negative inertia, {inertia.value:.3g} {body.unit('inertia')}, "
            "although friction brakes: a force moves the body that neither the log nor the model "
            "has, such as that of a spring, a hand or a coupled body, or a sign is wrong.",
            numbers,
            place,
        )
    if not inertia.sure:
        text = (
            "no sign or unit contradicts the motion, but the motion does not determine an inertia"
        )
    else:
        text = (
            f"signs and units agree: the motion requires an inertia of {inertia.value:.3g} "
            f"{body.unit('inertia')}, the model states {of_model:.3g} {body.unit('inertia')}"
        )
    if balance.other:
        gain = with_standard_error(balance.gain.value, balance.gain.error)
        text += f"; {balance.other} balances the other forces with a factor of {gain}"
    return Finding("signs and units", "fine", f"{text}.", numbers, place)
