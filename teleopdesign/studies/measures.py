"""Measures: what is kept of each point; the package's own by name, or any function of a result.

    "tracking_error"                              one of the package's own
    measure("rms", signal="R_M")                  with its options
    lambda simulation: float(abs(simulation["E"]).max())

A function takes what the point gave: the simulation where there is a duration, else the diagram, or
what the model's function returned. It returns a number, a text, a mapping of names to such, or a
labelled array.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from ..by_value import ByValue
from ..errors import ModelError, did_you_mean
from ..expectations import described
from ..frozen import Catalogue
from ..simulate import Simulation
from .case import SimulatedCase


@dataclass(frozen=True)
class Amount:
    """A measured value: number, text, or numbers over one dimension.

    unit: SI; "": not known at this point, taken from another one
    over: (dimension, its values, its unit) of an array (n,)
    """

    value: Any
    unit: str = "1"
    text: str = ""
    over: tuple[str, tuple[float, ...], str] | None = None


@dataclass(frozen=True, eq=False)
class Point:
    """One point as measures see it.

    content: what the model gave there: a `SimulatedCase`, or anything that its function returned
    values: parameter -> value;  seed: of this point, the same wherever it is computed
    simulated: gives the simulation, where it was computed with those of other points
    """

    content: Any
    values: Mapping[str, Any]
    seed: tuple[int, ...] = (0, 0)
    simulated: Callable[[], Simulation] | None = None

    @property
    def case(self) -> SimulatedCase:
        """The case; ModelError where the model gave something else."""
        if not isinstance(self.content, SimulatedCase):
            raise ModelError(f"study: found {described(self.content)}, expected a diagram")
        return self.content

    @cached_property
    def simulation(self) -> Simulation:
        """The simulation, computed once for all measures."""
        if self.simulated is not None:
            return self.simulated()
        return self.content if isinstance(self.content, Simulation) else self.case.simulate()

    @property
    def result(self) -> Any:
        """What a user's own measure is given."""
        if not isinstance(self.content, SimulatedCase):
            return self.content
        return self.simulation if self.content.duration else self.content.diagram

    def rng(self) -> np.random.Generator:
        """Randomness of this point."""
        return np.random.default_rng(self.seed)


Function = Callable[..., Any]


@dataclass(frozen=True, eq=False)
class Kind(ByValue):
    """A measure that the package has: function(point, **options) -> Amount, or several by name.

    options: name -> default; `...` where it must be given
    signals: all that it needs of a simulation: signals, or options that name them
    """

    name: str
    function: Function
    options: Mapping[str, Any] = field(default_factory=dict)
    signals: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        return (self.function.__doc__ or "").strip().split("\n")[0]


@dataclass(frozen=True, eq=False)
class Measure(ByValue):
    """A measure with its options, under the name that its values get.

    function: takes a `Point` (of the package's own), or what the point gave
    signals: all that it needs of a simulation; none: it may need anything
    """

    name: str
    function: Function
    options: Mapping[str, Any] = field(default_factory=dict)
    of_package: bool = False
    signals: tuple[str, ...] = ()

    def __call__(self, point: Point) -> dict[str, Amount]:
        """The values of a point, by name."""
        value = self.function(point if self.of_package else point.result, **self.options)
        if isinstance(value, Mapping):
            return {str(k): _amount(v, f"{self.name}: {k}") for k, v in value.items()}
        return {self.name: _amount(value, self.name)}


def measure(name: str, **options: Any) -> Measure:
    """A measure of the package with options: measure("rms", signal="R_M").

    raises ModelError: no measure of that name, an option that it does not have or that is missing
    """
    kind = MEASURES[name]
    for option in options:
        if option not in kind.options:
            listed = ", ".join(kind.options) or "none"
            raise ModelError(
                f'measure {name}: no option "{option}", has {listed}'
                f"{did_you_mean(option, kind.options)}"
            )
    for option, default in kind.options.items():
        if default is ... and option not in options:
            raise ModelError(f'measure {name}: option "{option}" has no value')
    values = {**{k: v for k, v in kind.options.items() if v is not ...}, **options}
    signal = values.get("signal") if kind.options.get("signal", "") is ... else None
    label = f"{name}_{signal}" if signal else name
    signals = tuple(str(values.get(s, s)) for s in kind.signals)
    return Measure(label, kind.function, values, of_package=True, signals=signals)


def measures_of(content: Any) -> tuple[Measure, ...]:
    """One measure or several, by name where a mapping gives names.

    raises ModelError: a name twice, something that is no measure, none at all
    """
    if isinstance(content, Mapping):
        listed = [_measure_of(m, str(name)) for name, m in content.items()]
    elif isinstance(content, str | Measure) or callable(content):
        listed = [_measure_of(content)]
    else:
        listed = [_measure_of(m) for m in content]
    names = [m.name for m in listed]
    if doubled := {n for n in names if names.count(n) > 1}:
        raise ModelError(
            f'study: measures: "{min(doubled)}" is there twice: name them, {{"name": measure}}'
        )
    if not listed:
        raise ModelError(f"study: found no measure, expected a function or {', '.join(MEASURES)}")
    return tuple(listed)


def _measure_of(content: Any, name: str = "") -> Measure:
    if isinstance(content, str):
        content = measure(content)
    if isinstance(content, Measure):
        return replace(content, name=name) if name else content
    if not callable(content):
        raise ModelError(
            f"study: measures: found {described(content)}, expected a function or a name of "
            f"{', '.join(MEASURES)}"
        )
    label = getattr(content, "__name__", type(content).__name__)
    return Measure(name or ("measure" if label == "<lambda>" else label), content)


def _amount(value: Any, where: str) -> Amount:
    """A value of a user's measure as the package keeps it."""
    if isinstance(value, Amount):
        return value
    if hasattr(value, "dims") and hasattr(value, "attrs"):  # a labelled array
        unit, text = str(value.attrs.get("units", "1")), str(value.attrs.get("text", ""))
        if not value.dims:
            return replace(_amount(value.values[()], where), unit=unit, text=text)
        if len(value.dims) == 1 and value.dtype.kind in "biuf":
            (dimension,) = value.dims
            along = value[dimension]
            over = (
                str(dimension),
                tuple(float(x) for x in along.values),
                str(along.attrs.get("units", "1")),
            )
            return Amount([float(x) for x in value.values], unit, text, over)
        raise ModelError(f"measure {where}: found {len(value.dims)} dimensions, expected one")
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, np.ndarray | list | tuple):
        array = np.asarray(value)
        if array.ndim == 1 and array.dtype.kind in "biuf":
            over = (f"{where}_entry", tuple(float(i) for i in range(len(array))), "1")
            return Amount([float(x) for x in array], over=over)
    if isinstance(value, bool | int | float):
        return Amount(float(value))
    if isinstance(value, str):
        return Amount(value)
    if value is None:
        return Amount(float("nan"), "")
    raise ModelError(
        f"measure {where}: found {described(value)}, expected a number, a text, a mapping of names "
        "to such, or a labelled array"
    )


# ---- the package's own ----------------------------------------------------------------------


def _rows(point: Point, signal: str, after: float) -> tuple[np.ndarray, str]:
    """A signal from that time on, and its unit."""
    data = point.simulation[signal]
    kept = point.simulation.data["time"].values >= after - 1e-9
    if not kept.any():
        raise ModelError(f"measure: after = {after:g} s is beyond the end of the simulation")
    return data.values[kept], str(data.attrs["units"])


def _rms(point: Point, *, signal: str, after: float) -> Amount:
    """root mean square of a signal, from the time `after` (s) on"""
    values, unit = _rows(point, signal, after)
    return Amount(float(np.sqrt(np.mean(values**2))), unit, f"rms of {signal}")


def _peak(point: Point, *, signal: str, after: float) -> Amount:
    """largest size of a signal, from the time `after` (s) on"""
    values, unit = _rows(point, signal, after)
    return Amount(float(np.abs(values).max()), unit, f"largest size of {signal}")


def _force_error(point: Point, *, after: float) -> Amount:
    """rms of the force error R_D - R_M of a haptic interface"""
    return replace(_rms(point, signal="E", after=after), text="rms of the force error R_D - R_M")


def _tracking_error(point: Point, *, after: float) -> Amount:
    """rms of the position error X_m - X_s of a teleoperator"""
    amount = _rms(point, signal="X_e", after=after)
    return replace(amount, text="rms of the position error X_m - X_s")


def _transparency_error(point: Point, *, after: float) -> Amount:
    """rms of the user's force less that of the tip on the environment, at the same time"""
    from ..simulate import force_displacement

    curves = force_displacement({"": point.simulation}, after=after)
    text = "rms of the user's force less that of the tip"
    return Amount(curves.rms[""], curves.data["force"].attrs["units"], text)


def _impedance(point: Point, *, frequency: Any, amplitude: float, motion: str, force: str) -> Any:
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


def _energy_drawn(point: Point, *, motion: str, force: str) -> Amount:
    """most energy that a port has given out, beyond what went in before"""
    from ..passivity import observe_simulation

    lowest = observe_simulation(point.simulation, motion=motion, force=force).lowest
    return Amount(max(0.0, -lowest), "J", f"energy drawn at the port ({force}, {motion})")


def _limit_cycle_amplitude(point: Point, *, signal: str, last: float) -> Amount:
    """half the range of a signal over the last part of the simulation (`last` of its time)"""
    if not 0 < last <= 1:
        raise ModelError(f"measure limit_cycle_amplitude: last: found {last:g}, expected 0 to 1")
    end = float(point.simulation.data["time"].values[-1])
    values, unit = _rows(point, signal, (1 - last) * end)
    half = float(values.max() - values.min()) / 2
    return Amount(half, unit, f"half the range of {signal} in the last {100 * last:g} % of time")


def _growth(point: Point, *, signal: str) -> Amount:
    """growth of a swing: range in the last third of the simulation over the middle third, less 1

    -1 where the swing has died out, infinite where signals grow beyond all bounds
    """
    from .onset import growth

    text = f"range of {signal} in the last third over the middle third, less 1"
    return Amount(growth(lambda: point.simulation, signal), "1", text)


def _onset(
    point: Point, *, parameter: str, low: float, high: float, signal: str, steps: int
) -> Amount:
    """least value of a parameter, between low and high (> 0), at which a swing grows

    by bisection of the logarithm; NaN where the swing grows at low already, or not at high
    """
    from .onset import growth, least_that_grows

    case = point.case
    case.check_names([parameter])
    if not 0 < low < high:
        raise ModelError(f"measure onset: found {low:g} to {high:g}, expected 0 < low < high")

    def grows(value: float) -> bool:
        return growth(case.with_values({parameter: value}).simulate, signal) > 0

    least = least_that_grows(grows, within=(low, high), steps=steps)
    return Amount(least, case.unit(parameter), f"least {parameter} at which {signal} grows")


def _claim(point: Point) -> Any:
    """status ("proved" ...) and margin of the claim that the model's function returns"""
    from ..passivity import Claim

    if not isinstance(point.content, Claim):
        raise ModelError(
            f"measure claim: found {described(point.content)}, expected a model that gives a Claim"
        )
    return _of_claim(point.content, "claim")


def _of_claim(claim: Any, name: str) -> dict[str, Amount]:
    verdict = claim.verdict
    margin, unit = getattr(verdict, "margin", float("nan")), getattr(verdict, "unit", "")
    holds = float("nan") if claim.holds is None else float(claim.holds)
    return {
        f"{name}_status": Amount(claim.status, text="how the claim is settled"),
        f"{name}_holds": Amount(holds, text="1: it holds, 0: it does not, NaN: unknown"),
        f"{name}_margin": Amount(float(margin), unit, "how far the claim is from failing"),
    }


def _passivity(point: Point, *, stroke: float, speed: float, tries: int) -> Any:
    """what the package settles about all ports of the diagram: status and margin

    "refuted" if any claim on a port is; else the weakest of the claims that settle it
    """
    from ..passivity.diagram_claims import WHOLE, Search, diagram_claims

    case = point.case
    search = Search(stroke, speed, tries, case.computer)
    claims = diagram_claims(case.diagram, rng=point.rng(), search=search).claims
    whole = [s.claim for s in claims if s.topic in WHOLE] or [s.claim for s in claims]
    order = ("refuted", "unknown", "evidence", "proved")
    against = [s.claim for s in claims if s.topic.startswith("search") and s.claim.holds is False]
    chosen = min(against or whole, key=lambda claim: order.index(claim.status))
    return _of_claim(chosen, "passivity")


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


_AFTER = {"after": 0.0}
_PORT = {"motion": "L", "force": "R_V"}

MEASURES: Catalogue[Kind] = Catalogue(
    {
        k.name: k
        for k in (
            Kind("rms", _rms, {"signal": ..., **_AFTER}, ("signal",)),
            Kind("peak", _peak, {"signal": ..., **_AFTER}, ("signal",)),
            Kind("force_error", _force_error, _AFTER, ("E",)),
            Kind("tracking_error", _tracking_error, _AFTER, ("X_e",)),
            Kind(
                "transparency_error",
                _transparency_error,
                _AFTER,
                ("X_m", "F_m", "X_s", "F_s"),
            ),
            Kind(
                "impedance",
                _impedance,
                {"frequency": ..., "amplitude": ..., "motion": "L", "force": "E"},
            ),
            Kind("energy_drawn", _energy_drawn, _PORT, ("motion", "force")),
            Kind(
                "limit_cycle_amplitude",
                _limit_cycle_amplitude,
                {"signal": ..., "last": 0.25},
                ("signal",),
            ),
            Kind("growth", _growth, {"signal": ...}, ("signal",)),
            Kind(
                "onset",
                _onset,
                {"parameter": ..., "low": ..., "high": ..., "signal": ..., "steps": 10},
            ),
            Kind("claim", _claim),
            Kind("passivity", _passivity, {"stroke": 0.01, "speed": 0.1, "tries": 15}),
            Kind("verdict", _verdict),
        )
    },
    "measure",
)
