"""What linear theory says: friction as the damper that takes the same energy in a cycle.

Bode plots need linear blocks. Friction becomes a damper that takes, along the stated motion, the
energy that the friction level takes; a Dahl cancellation a negative one in the same way; smoothed
friction and schedules are frozen at the mean speed of the motion.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from ..blocks import Body, Value
from ..controllers import Controller
from ..diagrams import Control, Diagram, four_cases
from ..effects import EFFECTS
from ..frequency import FrequencyResponse, bode
from ..passivity.rate_independent import dahl_loss
from .quasi_static import force_needed
from .stated_motion import StatedMotion

FRICTION = ("friction_level", "friction_factor", "friction_speed", "friction_shape")


def linear_cases(hybrid: Diagram, motion: StatedMotion) -> dict[str, Diagram]:
    """The four cases with friction, and a Dahl cancellation, as dampers of equal loss."""
    return {case: _linear(diagram, motion) for case, diagram in four_cases(hybrid).items()}


def mean_speed(motion: StatedMotion) -> float:
    """Mean speed of the motion, m/s or rad/s."""
    return 2 * motion.peak_speed / math.pi


def linear_error(hybrid: Diagram, motion: StatedMotion) -> tuple[Mapping[str, float], str]:
    """Rms force error of each case along the motion by abs(Zhat_M) A, and what was left out."""
    at = np.array([motion.frequency])
    found = bode(
        linear_cases(hybrid, motion),
        output="E",
        input="L",
        given="L",
        frequency=at,
        speed=mean_speed(motion),
    )
    size = found.data["magnitude"].values[:, 0] * motion.amplitude / math.sqrt(2)
    gone = sorted({name.partition(".")[2] or name for v in found.left_out.values() for name in v})
    return dict(zip(found.left_out, map(float, size), strict=True)), ", ".join(gone)


def transparency(hybrid: Diagram, motion: StatedMotion) -> FrequencyResponse:
    """T, from R_D to R_M, of the four cases; the diagram has a load in the place of the hand."""
    frequency = np.geomspace(0.1, 100.0, 301)
    return bode(linear_cases(hybrid, motion), frequency=frequency, speed=mean_speed(motion))


def _linear(diagram: Diagram, motion: StatedMotion) -> Diagram:
    (place,) = (b for b in diagram.bodies if b.name == "Z_M")
    body = place.body
    assert isinstance(body, Body)
    damping = _equal_damping(body, motion)
    for block in diagram.controls:
        assert isinstance(block.controller, Controller)
        if block.controller.stages[0].law.name == "dahl":
            damping -= _dahl_damping(block, motion)
            diagram = diagram.without(block.name)
    return diagram.with_block("Z_M", with_damping(body, damping))


def with_damping(body: Body, damping: float) -> Body:
    """The body without friction, with a damper more (N s/m), never less than none in all."""
    for effect in [e for e in reversed(body.effects) if e.role in FRICTION]:
        body = body.without_effect(effect.name)
    own = body.parameters["viscous.damping"].value if body.has("viscous") else 0.0
    if not body.has("viscous"):
        body = body.with_effect(EFFECTS["viscous"])
    return body.with_values({"viscous.damping": Value(max(own + damping, 0.0))})


def _equal_damping(body: Body, motion: StatedMotion) -> float:
    """Damping that takes the energy of sliding friction along a cycle, N s/m."""
    _, friction = force_needed(body, motion)
    _, _, velocity, _ = motion.cycle(len(friction))
    return float(np.mean(friction * velocity) / np.mean(velocity**2))


def _dahl_damping(block: Control, motion: StatedMotion) -> float:
    assert isinstance(block.controller, Controller)
    values = block.controller.stages[0].values
    loss = dahl_loss(values["level"], values["stiffness"], motion.amplitude)
    return loss / (math.pi * motion.omega * motion.amplitude**2)
