"""The measures of the package: one function of a point each, listed in `MEASURES`.

The first line of each function's docstring is printed as the help text of its measure.

Onset of instability: whether an oscillation grows, and the parameter at which that begins.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..base.errors import GrowsWithoutBound, ModelError
from ..base.expectations import describe_value
from ..base.frozen import Catalogue
from ..simulate import Simulation
from .point import Amount, Kind, Point


def _rows(point: Point, signal: str, after: float) -> tuple[np.ndarray, str]:
    """The samples of a signal from the time `after` (s) on, and its unit."""
    rows = point.signal(signal)
    kept = rows.time >= after - 1e-9
    if not kept.any():
        raise ModelError(f"measure: after = {after:g} s is beyond the end of the simulation")
    return rows.values[kept], rows.unit


def _rms(point: Point, *, signal: str, after: float = 0.0) -> Amount:
    """root mean square of a signal, from the time `after` (s) on"""
    values, unit = _rows(point, signal, after)
    with np.errstate(over="ignore"):  # a motion without bound
        return Amount(float(np.sqrt(np.mean(values**2))), unit, f"rms of {signal}")


def _peak(point: Point, *, signal: str, after: float = 0.0) -> Amount:
    """largest size of a signal, from the time `after` (s) on"""
    values, unit = _rows(point, signal, after)
    return Amount(float(np.abs(values).max()), unit, f"largest size of {signal}")


def _force_error(point: Point, *, after: float = 0.0) -> Amount:
    """rms of the force error R_D - R_M of a haptic interface"""
    return replace(_rms(point, signal="E", after=after), text="rms of the force error R_D - R_M")


def _tracking_error(point: Point, *, after: float = 0.0) -> Amount:
    """rms of the position error X_m - X_s of a teleoperator"""
    amount = _rms(point, signal="X_e", after=after)
    return replace(amount, text="rms of the position error X_m - X_s")


def _transparency_error(point: Point, *, after: float = 0.0) -> Amount:
    """rms of the user's force less that of the tip on the environment, at the same time"""
    from ..simulate import force_displacement

    curves = force_displacement({"": point.simulation}, after=after)
    text = "rms of the user's force less that of the tip"
    return Amount(curves.rms[""], curves.data["force"].attrs["units"], text)


def _impedance(
    point: Point,
    *,
    frequency: float | Sequence[float],
    amplitude: float,
    motion: str = "L",
    force: str = "E",
) -> Any:
    """impedance force/motion at frequencies (Hz), measured with a sinusoid of that amplitude"""
    from ..frequency import measured_impedance

    frequencies = np.atleast_1d(np.asarray(frequency, dtype=float))
    case = point.case
    measured = measured_impedance(
        case.diagram,
        amplitude=amplitude,
        frequency=frequencies,
        motion=motion,
        force=force,
        computer=case.computer,
    )
    z = measured.data["impedance"].values.reshape(-1)
    over = ("frequency", tuple(float(f) for f in frequencies), "Hz")
    unit = str(measured.data["impedance"].attrs["units"])
    phase = np.degrees(np.angle(z)) % 360
    return {
        "impedance_size": Amount([float(x) for x in np.abs(z)], unit, "size of impedance", over),
        "impedance_phase": Amount([float(x) for x in phase], "deg", "phase of impedance", over),
    }


def _energy_drawn(point: Point, *, motion: str = "L", force: str = "R_V") -> Amount:
    """most energy that a port has released, kinetic energy of a start at speed included

    the start is not known to the sum: a sine of phase 0 begins at its largest speed, and its
    kinetic energy counts as released
    """
    from ..passivity import observe_simulation

    lowest = observe_simulation(point.simulation, motion=motion, force=force).lowest
    return Amount(max(0.0, -lowest), "J", f"energy drawn at the port ({force}, {motion})")


def _limit_cycle_amplitude(point: Point, *, signal: str, last: float = 0.25) -> Amount:
    """half the range of a signal over the last part of the simulation (`last` of its time)"""
    if not 0 < last <= 1:
        raise ModelError(f"measure limit_cycle_amplitude: last: found {last:g}, expected 0 to 1")
    end = float(point.signal(signal).time[-1])
    values, unit = _rows(point, signal, (1 - last) * end)
    half = float(values.max() - values.min()) / 2
    return Amount(half, unit, f"half the range of {signal} in the last {100 * last:g} % of time")


def _growth(point: Point, *, signal: str) -> Amount:
    """growth of a motion: range in the last third of the simulation over the middle third, less 1

    -1 where the motion has died out, infinite where signals grow beyond all bounds
    """
    text = f"range of {signal} in the last third over the middle third, less 1"
    return Amount(growth_of(lambda: point.signal(signal).values), "1", text)


def _onset(
    point: Point, *, parameter: str, low: float, high: float, signal: str, steps: int = 10
) -> Amount:
    """least value of a parameter, between low and high (> 0), at which a motion grows

    by bisection of the logarithm: the least one only where growth, once begun, goes on up to high;
    NaN where the motion grows at low already, or not at high
    """
    case = point.case
    case.check_names([parameter])
    if not 0 < low < high:
        raise ModelError(f"measure onset: found {low:g} to {high:g}, expected 0 < low < high")

    def grows(value: float) -> bool:
        return growth(case.with_values({parameter: value}).simulate, signal) > 0

    least = find_onset(grows, within=(low, high), steps=steps)
    return Amount(least, case.unit(parameter), f"least {parameter} at which {signal} grows")


def _claim(point: Point) -> Any:
    """status ("proved" ...) and margin of the claim that the model's function returns"""
    from ..passivity import Claim

    if not isinstance(point.content, Claim):
        raise ModelError(
            f"measure claim: found {describe_value(point.content)}, "
            "expected a model that gives a Claim"
        )
    return _amounts_of_claim(point.content, "claim")


def _amounts_of_claim(claim: Any, name: str) -> dict[str, Amount]:
    verdict = claim.verdict
    margin, unit = getattr(verdict, "margin", float("nan")), getattr(verdict, "unit", "")
    holds = float("nan") if claim.holds is None else float(claim.holds)
    return {
        f"{name}_status": Amount(claim.status, text="verdict of the claim"),
        f"{name}_holds": Amount(holds, text="1: it holds, 0: it does not, NaN: unknown"),
        f"{name}_margin": Amount(float(margin), unit, "how far the claim is from failing"),
    }


def _passivity(point: Point, *, stroke: float = 0.01, speed: float = 0.1, tries: int = 15) -> Any:
    """what the package settles about all ports of the diagram: status and margin

    "refuted" if any claim on a port is; else the weakest of the claims that settle it. With a
    computer that samples these are proofs in continuous time and a search with its samples
    """
    from ..passivity.diagram_claims import SEARCHED, Search, diagram_claims
    from ..passivity.friction_pairs import friction_pairs, refuting
    from ..passivity.linear_diagrams import WHOLE
    from ..passivity.ports import drop_absent_effects, without_holders

    case = point.case
    search = Search(stroke, speed, tries, case.computer)
    claims = diagram_claims(case.diagram, rng=point.rng(), search=search).claims
    # what is proved of a diagram holds in continuous time: with a computer the search counts, too
    searched = [s for s in claims if s.topic.endswith(SEARCHED)]
    whole = [s for s in claims if s.topic in WHOLE]
    order = ("refuted", "unknown", "evidence", "proved")
    settling = [*whole, *searched] if whole else claims
    # what refutes a law beside friction need not refute the diagram
    alone = without_holders(drop_absent_effects(case.diagram))
    against = {c.statement for c in refuting(alone, friction_pairs(alone))}
    counted = (
        s.claim
        for s in settling
        if s in (*whole, *searched) or s.claim.status != "refuted" or s.claim.statement in against
    )
    chosen = min(counted, key=lambda claim: order.index(claim.status))
    return _amounts_of_claim(chosen, "passivity")


def _verdict(point: Point) -> Any:
    """verdict of a diagnosis, the effects it names, its check error before and after

    of an experiment, its folder, or a diagnosis that the model's function returns
    """
    from ..diagnose import Diagnosis, find_missing
    from ..measurement import Experiment, load_experiment

    diagnosis = point.content
    if not isinstance(diagnosis, Diagnosis):
        experiment = diagnosis
        if not isinstance(experiment, Experiment):
            experiment = load_experiment(experiment)
        diagnosis = find_missing(experiment)
    return {
        "verdict": Amount(diagnosis.verdict, text="what the diagnosis ends with"),
        "missing": Amount(", ".join(map(str, diagnosis.missing)), text="effects that are named"),
        "check_error_before": Amount(diagnosis.before.check_error, text="of the model as given"),
        "check_error_after": Amount(diagnosis.after.check_error, text="with the effects added"),
    }


_KINDS = (
    Kind(_rms, ("signal",)),
    Kind(_peak, ("signal",)),
    Kind(_force_error, ("E",)),
    Kind(_tracking_error, ("X_e",)),
    Kind(_transparency_error, ("X_m", "F_m", "X_s", "F_s")),
    Kind(_impedance),
    Kind(_energy_drawn, ("motion", "force")),
    Kind(_limit_cycle_amplitude, ("signal",)),
    Kind(_growth, ("signal",)),
    Kind(_onset),
    Kind(_claim),
    Kind(_passivity),
    Kind(_verdict),
)
MEASURES: Catalogue[Kind] = Catalogue({kind.name: kind for kind in _KINDS}, "measure")


#: a swing has died out if it is below this share of the largest one: smaller swings are creep of
#: bristles and rounding, and their ratios have no meaning
DIED_OUT = 1e-3


def growth(simulated: Callable[[], Simulation], signal: str) -> float:
    """Range of the signal in the last third of the simulation over the middle third, less 1.

    -1: the oscillation has died out;  inf: signals grow without bound
    """
    return growth_of(lambda: np.asarray(simulated()[signal].values))


def growth_of(samples: Callable[[], np.ndarray]) -> float:
    """As `growth`, from the samples of a signal, (rows,)."""
    try:
        values = samples()
    except GrowsWithoutBound:
        return math.inf
    middle, last = (float(np.ptp(part)) for part in np.array_split(values, 3)[1:])
    if last <= DIED_OUT * np.ptp(values):
        return -1.0
    return last / middle - 1 if middle > 0 else math.inf


def find_onset(grows: Callable[[float], bool], *, within: tuple[float, float], steps: int) -> float:
    """A value at which growth begins; NaN if a simulation grows at low already, or not at high.

    It is the smallest one only where every larger value grows too: bisection sees no island of
    growth below it.
    grows: whether the simulation with a value grows;  within: lowest and highest value, > 0
    steps: halvings of the logarithm: the result is within (high/low)^(2^-steps) of the onset
    """
    low, high = within
    if not grows(high) or grows(low):
        return float("nan")
    for _ in range(steps):
        middle = math.sqrt(low * high)
        low, high = (low, middle) if grows(middle) else (middle, high)
    return high
