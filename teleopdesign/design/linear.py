"""Linear theory of a design: friction as a damper and a spring with the same first harmonic.

Bode plots need linear blocks. Friction is replaced by a damper, and with presliding also by a
spring, with the same first harmonic along the stated motion. A Dahl cancellation reduces both in
the same way. Smoothed friction and schedules are frozen at the mean speed of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Controller
from ..diagrams import Diagram, four_cases
from ..frequency import FrequencyResponse, ParameterCovariance, bode, describing_function
from ..frequency.closed_forms import dahl
from ..frequency.confidence import ResponseBand, confidence_band
from ..frequency.frozen_friction import without_friction
from .assumptions import StatedMotion
from .quasi_static import force_needed


def linear_cases(hybrid: Diagram, motion: StatedMotion) -> dict[str, Diagram]:
    """The four cases, with friction and a Dahl cancellation as equivalent dampers and springs."""
    return {
        case: _linear(diagram, motion) for case, diagram in four_cases(hybrid, every=True).items()
    }


def mean_speed(motion: StatedMotion) -> float:
    """Mean speed of the motion, m/s or rad/s."""
    return 2 * motion.peak_speed / math.pi


def linear_error(hybrid: Diagram, motion: StatedMotion) -> tuple[Mapping[str, float], str]:
    """Rms force error of each case along the motion by abs(Zhat_M) A, and the neglected effects."""
    at = np.array([motion.frequency])
    gains = bode(
        linear_cases(hybrid, motion),
        output="E",
        input="L",
        given="L",
        frequency=at,
        speed=mean_speed(motion),
    )
    size = gains.magnitude[:, 0] * motion.amplitude / math.sqrt(2)
    gone = sorted({name.partition(".")[2] or name for v in gains.left_out.values() for name in v})
    return dict(zip(gains.left_out, map(float, size), strict=True)), ", ".join(gone)


def transparency(
    hybrid: Diagram, motion: StatedMotion, covariance: ParameterCovariance
) -> FrequencyResponse:
    """T, from R_D to R_M, of the four cases, with the band that the estimates of the device leave.

    hybrid: with a load in place of the hand; C and H stay as designed
    """

    def response(diagram: Diagram) -> FrequencyResponse:
        cases = linear_cases(diagram, motion)
        return bode(cases, frequency=np.geomspace(0.1, 100.0, 301), speed=mean_speed(motion))

    made = response(hybrid)
    if not covariance.names:
        return made

    def values(diagram: Diagram) -> NDArray[np.complex128]:
        one = response(diagram)
        return np.array([one.values(case) for case in one.cases])

    band = confidence_band(values, [hybrid], covariance)
    return replace(made, band=ResponseBand(band.log_magnitude[0], band.phase[0], band.undetermined))


def _linear(diagram: Diagram, motion: StatedMotion) -> Diagram:
    (place,) = (b for b in diagram.bodies if b.name == "Z_M")
    body = place.body
    assert isinstance(body, Body)
    damping, stiffness = _equal_friction(body, motion)
    for block in diagram.controls:
        assert isinstance(block.controller, Controller)
        if all(stage.law.linear for stage in block.controller.stages):
            continue
        if (less := first_harmonic(block.controller, motion)) is not None:
            damping, stiffness = damping - less.imag / motion.omega, stiffness - less.real
            diagram = diagram.without(block.name)
    return diagram.with_block("Z_M", without_friction(body, damping=damping, stiffness=stiffness))


def first_harmonic(law: Controller, motion: StatedMotion) -> complex | None:
    """First harmonic of a law that the motion drives, N/m or N m/rad; None: it has none."""
    try:
        harmonic = describing_function(law, amplitude=motion.amplitude, frequency=motion.frequency)
    except ModelError:
        return None
    return complex(harmonic)


def _equal_friction(body: Body, motion: StatedMotion) -> tuple[float, float]:
    """Damping and stiffness equivalent to friction along a cycle, N s/m and N/m (P16, P18)."""
    _, friction = force_needed(body, motion)
    _, _, velocity, _ = motion.cycle(len(friction))
    if not velocity.any() or not friction.any():
        return 0.0, 0.0
    stiffness = body.parameters.get("presliding.stiffness")
    if stiffness is not None and math.isfinite(stiffness.value):
        # of a level that varies, that which takes the same energy while it slides
        level = float(np.mean(friction * velocity) / np.mean(np.abs(velocity)))
        return _equal_dahl(level, stiffness.value, motion)
    return float(np.mean(friction * velocity) / np.mean(velocity**2)), 0.0


def _equal_dahl(level: float, stiffness: float, motion: StatedMotion) -> tuple[float, float]:
    """Damping and stiffness of the first harmonic of Dahl friction, N s/m and N/m (P18)."""
    first = complex(sp.N(dahl(level, stiffness, motion.amplitude)))
    return first.imag / motion.omega, first.real
