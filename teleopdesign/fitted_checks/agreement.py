"""Do forces, motion and model agree in sign, unit and time? Plain findings from `force_balance`.

The findings come from one linear fit to the rows in motion. A warning is issued where the user's
columns, as labelled, contradict each other by far more than an effect could.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import combinations

from ..base.finding import Finding
from ..base.sentences import percent, with_standard_error
from ..base.units import unit_of
from ..check import CheckedRecording, RecordingCheck
from ..check.arm_columns import SWAPPED
from ..check.computed_command import describe_computed
from ..measurement.experiment import Experiment
from ..measurement.first_guess import is_first_guess
from ..measurement.prepare import prepare
from ._force_balance import ForceBalance, force_balances
from ._timing import UNEXPLAINED, check_lateness
from ._units import FAR, NEAR, check_strengths

#: a gain between 1/CALIBRATED and CALIBRATED is the calibration of a force sensor and needs no
#: note. A gain with a relative standard error above UNSURE is not known
CALIBRATED, UNSURE = 1.25, 0.05
#: part of the force that is left unexplained, above which there is no finding on signs, units,
#: shifts
NOTHING = 0.9


def find_disagreements(recording: CheckedRecording) -> Iterator[Finding]:
    """Findings on sign, unit and timing of the channels of every body."""
    balances = force_balances(*recording.compared)
    if swapped := list(_find_swapped(recording, balances)):
        yield from swapped
        return
    later = force_balances(*recording.compared, timed=False, use="check")
    for body, balance in balances.items():
        contradictions = []
        if balance.left <= NOTHING:
            contradictions = [*_signs(recording, balance), *_gain(recording, balance)]
        if not contradictions and body in later and later[body].left <= NOTHING:
            of_check = _signs(recording, later[body])
            contradictions = [replace(f, sentence=f"check records: {f.sentence}") for f in of_check]
        if not contradictions:
            if balance.left <= NOTHING:
                contradictions += check_strengths(recording, balance)
            contradictions += check_lateness(recording, balance)
        yield from contradictions or [_agreement(recording, balance)]
        if balance.left <= NOTHING:
            yield from _calibration(recording, balance)


CHECK = RecordingCheck(
    order=20, find=find_disagreements, unless={"bandwidth": "choose a bandwidth"}
)


def _find_swapped(
    recording: CheckedRecording, balances: Mapping[str, ForceBalance]
) -> Iterator[Finding]:
    """Columns of two bodies that fit far better if swapped, where the residual is large."""
    model, prepared = recording.compared
    keys, before = prepared.experiment.channels, _worst(balances)
    if before < UNEXPLAINED:
        return
    for one, two in combinations(model.bodies, 2):
        for quantity in ("position", "actuator_force", "interaction_force"):
            a, b = f"{one}.{quantity}", f"{two}.{quantity}"
            if a not in keys or b not in keys:
                continue
            exchanged = _exchange_columns(prepared.experiment, a, b)
            other = prepare(exchanged, bandwidth=prepared.bandwidth)
            after = _worst(force_balances(model, other, timed=False))
            if after < SWAPPED * before:
                shares = [percent(part, ".2g") for part in (before, after)]
                sentence = (
                    f"the columns of {a} and {b} seem swapped: {shares[0]} of the force in motion "
                    f"is left unexplained, {shares[1]} the other way round."
                )
                numbers = {"as_given": before, "swapped": after}
                yield Finding("swapped columns", "warning", sentence, numbers)


def _worst(balances: Mapping[str, ForceBalance]) -> float:
    return max((b.left for b in balances.values()), default=0.0)


def _exchange_columns(experiment: Experiment, a: str, b: str) -> Experiment:
    records = tuple(
        replace(r, signals={**r.signals, a: r.signals[b], b: r.signals[a]})
        for r in experiment.records
    )
    return replace(experiment, records=records)


def _signs(recording: CheckedRecording, balance: ForceBalance) -> Iterator[Finding]:
    """A finding where friction drives or inertia is negative: a channel has the wrong sign."""
    inertia, experiment = balance.strengths["inertia"], recording.experiment
    powers = [p for n, p in balance.power.items() if n != "inertia"]
    braking = max(powers, key=lambda p: abs(p.value), default=None)
    brakes = 0 if braking is None else braking.sure
    against = balance.gain.sure < 0
    turned = inertia.sure < 0 and brakes <= 0 or inertia.sure == 0 and brakes < 0
    if not (against or turned):
        return
    if describe_computed(experiment, balance.body):
        return  # the spring and the damper of a controller, against which a hand moves the device
    lead, other, position = (
        recording.label(f"{balance.body}.{q}") for q in (balance.lead, balance.other, "position")
    )
    wrong = other if against and not turned else lead if against else position
    if not against and not balance.other:
        wrong = f"{lead} or {position}"
    unit = unit_of("inertia", experiment.axis(balance.body))
    drives = f" and friction drives with {-braking.value:.3g} W" if braking and brakes < 0 else ""
    evidence = f"the inertia is {inertia.value:.3g} {unit}{drives}"
    if against and not turned:
        evidence = f"the force that balances {lead} is {balance.gain.value:.3g} times it"
    unlogged = f"{balance.body}.interaction_force" not in experiment.channels
    looks = " A hand that moves the device and is not logged looks the same."
    yield Finding(
        "signs",
        "warning",
        f"{wrong} has the opposite sign: as recorded, {evidence}. All forces on a body and its "
        f"position are positive the same way.{looks if unlogged else ''}",
        {
            "gain": balance.gain.value,
            "inertia": inertia.value,
            "power": float("nan") if braking is None else braking.value,
        },
        balance.body,
    )


def _gain(recording: CheckedRecording, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on a second force whose scale is far from that of the first: a wrong unit."""
    gain = balance.gain
    if not balance.other or gain.sure <= 0 or 1 / FAR < gain.value < FAR:
        return
    lead, other = (recording.label(f"{balance.body}.{q}") for q in (balance.lead, balance.other))
    inertia = recording.compared[0].body(balance.body).parameters["inertia"].value
    ratio = balance.strengths["inertia"].value / inertia if inertia else float("nan")
    wrong = "one of the two is"
    if abs(math.log10(max(ratio, 1e-300))) < NEAR:
        wrong = f"{other} is"
    elif abs(math.log10(max(ratio / gain.value, 1e-300))) < NEAR:
        wrong = f"{lead} is"
    sentence = (
        f"{other} is {1 / gain.value:.3g} times as large as the force that balances {lead}: "
        f"judging by the inertia, {wrong} in another unit than stated."
    )
    numbers = {"gain": gain.value, "error": gain.error, "inertia_ratio": ratio}
    yield Finding("units", "warning", sentence, numbers, balance.body)


def _calibration(recording: CheckedRecording, balance: ForceBalance) -> Iterator[Finding]:
    """A finding on a second force whose scale differs from the first by a calibration factor."""
    gain = balance.gain
    if not balance.other or gain.error > UNSURE * gain.value:
        return
    if not 1 / FAR < gain.value < FAR or 1 / CALIBRATED < gain.value < CALIBRATED:
        return
    lead, other = (recording.label(f"{balance.body}.{q}") for q in (balance.lead, balance.other))
    sentence = (
        f"{other} balances {lead} only when multiplied by "
        f"{with_standard_error(gain.value, gain.error)}: the "
        f"scale of one is wrong, such as a torque constant (scale = {gain.value:.4g} at "
        f"channels.{other}, or {1 / gain.value:.4g} times that of channels.{lead}), or the "
        "actuator gives another force than commanded (actuator_gain)."
    )
    numbers = {"gain": gain.value, "error": gain.error}
    yield Finding("force scales", "note", sentence, numbers, balance.body)


def _agreement(recording: CheckedRecording, balance: ForceBalance) -> Finding:
    body = recording.compared[0].body(balance.body)
    inertia, unit = balance.strengths["inertia"], body.unit("inertia")
    numbers = {"inertia": inertia.value, "left": balance.left, "gain": balance.gain.value}
    if inertia.sure < 0:
        sentence = (
            f"the motion requires a negative inertia, {inertia.value:.3g} {unit}, although "
            "friction brakes: a force moves the body that neither the log nor the model has, such "
            "as that of a spring, a hand or a coupled body, or a sign is wrong."
        )
        return Finding("signs and units", "note", sentence, numbers, balance.body)
    text = "no sign or unit contradicts the motion, but the motion does not determine an inertia"
    if inertia.sure:
        stated, records = body.parameters["inertia"], recording.experiment.fit_records
        text = f"the motion requires an inertia of {inertia.value:.3g} {unit}"
        if stated.fixed or not is_first_guess(records, balance.body, stated.value):
            text = f"signs and units agree: {text}, the model states {stated.value:.3g} {unit}"
        else:
            text = f"signs agree: {text}; units show only beside a known one (fixed = true)"
    if balance.other:
        gain = with_standard_error(balance.gain.value, balance.gain.error)
        text += f"; {balance.other} balances the other forces with a factor of {gain}"
    return Finding("signs and units", "fine", f"{text}.", numbers, balance.body)
