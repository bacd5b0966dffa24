"""Force error of the four cases, by linear theory, for slow motion, and by simulation.

The impedance that a hand feels, Zhat_M, is the first harmonic of the force error over the motion,
along sinusoids of the stated peak speed, at the stated frequency and above: by describing
functions, and by a simulation of all identified effects with sampling and delay.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..blocks import Body
from ..diagrams import Diagram, four_cases
from ..frequency import (
    ImpedanceMap,
    ParameterCovariance,
    measured_impedance,
    quasi_linear_impedance,
)
from ..realise.tips import led_motion
from ..simulate import ForceVelocity, Sampling, Simulation, force_velocity, simulate
from .assumptions import StatedMotion
from .linear import linear_error
from .quasi_static import quasi_static_error

if TYPE_CHECKING:
    import xarray

#: cycles simulated; the last one counts
CYCLES = 3
#: deflection of an ideal Coulomb contact before it slides in a simulation, as a part of the
#: amplitude
BRISTLE_SHARE = 1e-6
#: part of the peak speed below which the motion counts as near a reversal
REVERSAL = 0.3


@dataclass(frozen=True, eq=False)
class CasePrediction(ByValue):
    """Predictions for one case of compensation.

    Forces are in N or N m: rms about their mean over a cycle of the motion.

    linear, quasi_static, simulated: the force error by three methods
    at_peak_speed: mean absolute force error at the peak speed, simulated
    mean: of the simulated force error, which linear theory does not contain (gravity, offsets)
    energy: that the hand puts in per cycle, J, simulated
    apart: rms of simulated minus quasi-static;  at_reversals: part of its squares near reversals
    failed: reason why there is no simulation; "" if there is one
    """

    linear: float
    quasi_static: float
    simulated: float
    at_peak_speed: float
    mean: float
    energy: float
    apart: float
    at_reversals: float
    failed: str = ""


@dataclass(frozen=True, eq=False)
class Prediction(ByValue):
    """Predicted force errors.

    cases: by case;  curves: simulated force error over velocity
    left_out: effects that linear theory neglects;  hybrid: the diagram as simulated
    rigid: a structure of the body that could not be simulated and was taken as rigid; "" for none
    """

    motion: StatedMotion
    cases: Mapping[str, CasePrediction]
    curves: ForceVelocity
    left_out: str
    hybrid: Diagram
    rigid: str = ""


def steady_cycle(diagram: Diagram, motion: StatedMotion, sampling: Sampling) -> xarray.Dataset:
    """The signals of a steady cycle of a prescribed motion.

    raises ModelError: the diagram cannot be simulated
    """
    data = _simulate_case(diagram, motion, sampling, step=sampling.period / 10).data
    return data.isel(time=data["time"].values >= (CYCLES - 1) / motion.frequency)


def simulated_error(diagram: Diagram, motion: StatedMotion, sampling: Sampling) -> float:
    """Rms force error of one diagram about its mean over a steady cycle, N or N m.

    raises ModelError: the diagram cannot be simulated
    """
    return float(np.std(steady_cycle(diagram, motion, sampling)["E"].values))


def predict(
    hybrid: Diagram, motion: StatedMotion, sampling: Sampling, *, linear: Diagram
) -> Prediction:
    """Predict the force error of the four cases along a prescribed motion.

    hybrid: a device with C and H (either may be absent), without a hand
    linear: the same with the part of C of which linear theory has a first harmonic
    raises ModelError: not even the device without compensation can be simulated
    """
    by_theory, left_out = linear_error(linear, motion)
    simulated, rigid = _simulable(hybrid, motion, sampling)
    runs, failed = _simulate_cases(simulated, motion, sampling)
    speed = f"{led_motion(simulated, 'L')}_velocity"
    curves = force_velocity(runs, velocity=speed, after=(CYCLES - 1) / motion.frequency)
    cases = {
        case: _case(case, diagram, motion, by_theory[case], curves, failed.get(case, ""))
        for case, diagram in four_cases(hybrid, every=True).items()
    }
    return Prediction(motion, cases, curves, left_out, simulated, rigid)


def _simulate_cases(
    hybrid: Diagram, motion: StatedMotion, sampling: Sampling
) -> tuple[dict[str, Simulation], dict[str, str]]:
    """The simulations of the cases on one time grid, and why others could not be simulated."""
    step = sampling.period / 10
    while True:
        runs: dict[str, Simulation] = {}
        failed: dict[str, str] = {}
        for case, diagram in four_cases(hybrid, every=True).items():
            try:
                runs[case] = _simulate_case(diagram, motion, sampling, step=step)
            except ModelError as error:
                if case == "none":
                    raise
                failed[case] = str(error)
        finest = min(float(run.data.attrs["step_s"]) for run in runs.values())
        if all(run.data.attrs["step_s"] == finest for run in runs.values()):
            return runs, failed
        step = finest  # a case that needs a finer step takes the others with it


def _simulable(hybrid: Diagram, motion: StatedMotion, sampling: Sampling) -> tuple[Diagram, str]:
    """The diagram without a structure that cannot be simulated, and the name of the structure."""
    (body,) = (b.body for b in hybrid.bodies if b.name == "Z_M")
    assert isinstance(body, Body)
    structure = next((e.name for e in body.effects if e.role == "structure"), "")
    if structure:
        try:
            _simulate_case(four_cases(hybrid)["none"], motion, sampling, step=sampling.period / 10)
        except ModelError:
            # its inertia counts both sides
            return hybrid.with_block("Z_M", body.without_effect(structure)), structure
    return hybrid, ""


def _simulate_case(
    diagram: Diagram, motion: StatedMotion, sampling: Sampling, *, step: float
) -> Simulation:
    return simulate(
        diagram,
        duration=CYCLES / motion.frequency,
        motion={led_motion(diagram, "L"): motion.motion},
        computer=sampling,
        step=step,
        give=BRISTLE_SHARE * motion.amplitude,
        every_step=True,
    )


def _case(
    case: str,
    diagram: Diagram,
    motion: StatedMotion,
    linear: float,
    curves: ForceVelocity,
    failed: str,
) -> CasePrediction:
    none = float("nan")
    slow = quasi_static_error(diagram, motion)
    spread = float(np.std(slow))
    if failed:
        return CasePrediction(linear, spread, none, none, none, none, none, none, failed)
    data = curves.data.sel(case=case)
    time, force = data["time"].values, data["force"].values
    velocity = data["velocity"].values
    rows, _, _, _ = motion.cycle(len(slow))
    # whole cycles: the phase of each row in the cycle
    phase = np.mod(time, 1 / motion.frequency)
    difference = force - np.interp(phase, rows, slow, period=1 / motion.frequency)
    squares = difference**2
    near = np.abs(velocity) < REVERSAL * motion.peak_speed
    return CasePrediction(
        linear=linear,
        quasi_static=spread,
        simulated=float(np.std(force)),
        at_peak_speed=curves.at_peak_speed[case],
        mean=float(np.mean(force)),
        energy=float(np.mean(force * velocity) / motion.frequency),
        apart=float(np.sqrt(np.mean(squares))),
        at_reversals=float(squares[near].sum() / max(squares.sum(), 1e-300)),
    )


#: multiples of the stated frequency that are computed, and their upper limit as a part of the
#: sample rate
MULTIPLES, MOST = (1.0, 2.0, 5.0, 10.0), 0.05


@dataclass(frozen=True)
class FeltImpedance:
    """Zhat_M of the four cases; None where it could not be computed.

    simulated: measured in simulation
    predicted: by describing functions, with continuous controllers, and the band of the estimates
    missing: the reason for each None
    """

    simulated: ImpedanceMap | None
    predicted: ImpedanceMap | None
    missing: tuple[str, ...]


def felt_impedance(
    hybrid: Diagram, motion: StatedMotion, sampling: Sampling, covariance: ParameterCovariance
) -> FeltImpedance:
    """Zhat_M of the device without and with compensation at the stated peak speed.

    hybrid: a device with C and H (either may be absent), without a hand
    covariance: of the device's estimates; without names no band is known
    """
    cases = four_cases(hybrid, every=True)
    wanted = motion.frequency * np.array(MULTIPLES)
    wanted = wanted[wanted <= max(MOST / sampling.period, motion.frequency)]
    # whole samples a cycle, and readings without steps: every cycle is like the one before
    frequency = 1 / (sampling.period * np.round(1 / (sampling.period * wanted)))
    smooth = replace(sampling, encoder_step=0.0)
    missing: list[str] = []

    def amplitude(f: np.ndarray) -> np.ndarray:
        return np.asarray(motion.amplitude * motion.frequency / f)

    simulated = predicted = None
    if led_motion(hybrid, "L") != "L":
        # friction that deflects by 1e-5 of the motion, behind a spring: millions of steps
        return FeltImpedance(None, None, ("through a transmission it takes too many steps",))
    try:
        simulated = measured_impedance(
            cases, amplitude=amplitude, frequency=frequency, computer=smooth
        )
    except ModelError as error:
        missing.append(f"simulation: {error}")
    try:
        predicted = quasi_linear_impedance(
            cases,
            amplitude=amplitude,
            frequency=frequency,
            covariance=covariance if covariance.names else None,
        )
    except ModelError as error:
        missing.append(f"describing functions: {error}")
    return FeltImpedance(simulated, predicted, tuple(missing))
