"""A design as plain data, to be written as JSON; SI units."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from ..base.files import make_plain
from ..base.units import unit_of
from ..passivity import Claim
from .chosen import ProposedController
from .felt_impedance import FeltImpedance
from .force_feedback import FeedbackLoop

if TYPE_CHECKING:
    from .outcome import Design  # a design writes itself through this module


def design_data(design: Design) -> dict[str, Any]:
    """The design as plain data; a number that is not finite is null."""
    axis = design.body.axis
    residual = design.residual
    content = {
        "experiment": design.experiment,
        "place": design.place,
        "axis": axis,
        "units": {q: unit_of(q, axis) for q in ("force", "position", "velocity", "stiffness")},
        "model_parameters": {
            n: {"value": v.value, "stderr": v.stderr, "unit": design.body.unit(n)}
            for n, v in design.body.parameters.items()
        },
        "assumptions": asdict(design.assumptions),
        "recorded": asdict(design.reach),
        "friction": _friction(design),
        "cancellation": _chosen(design.cancellation),
        "second_cancellation": _chosen(design.other),
        "force_feedback": _chosen(design.force_feedback),
        "loop": _loop(design.loop),
        "loop_held_rigidly": _loop(design.held),
        "motion": asdict(design.prediction.motion),
        "prediction": {case: asdict(p) for case, p in design.prediction.cases.items()},
        "taken_rigid_in_simulation": design.prediction.rigid,
        "left_out_of_linear": design.prediction.left_out,
        "felt_impedance": _impedance(design.impedance),
        "residual_friction": {
            "speed": residual.speeds.tolist(),
            **{case: row.tolist() for case, row in residual.rows.items()},
        },
        "passivity": {case: [_claim(c) for c in claims] for case, claims in design.claims.items()},
        "notes": list(design.notes),
        "diagram_toml": design.to_toml(),
    }
    data: dict[str, Any] = make_plain(content)
    return data


def _friction(design: Design) -> dict[str, Any] | None:
    """The friction interval, and half of the travel in bristle lengths; None without friction."""
    if design.friction is None:
        return None
    lengths = design.friction.bristle_lengths(design.reach.travel)
    return {**asdict(design.friction), "bristle_lengths": lengths}


def _impedance(felt: FeltImpedance) -> dict[str, Any]:
    """Magnitude (dB) and phase (deg) of each case over frequency (Hz), simulated and predicted."""
    data: dict[str, Any] = {"missing": list(felt.missing)}
    for how, one in (("simulated", felt.simulated), ("predicted", felt.predicted)):
        if one is None:
            continue
        data["frequency"] = one.data["frequency"].values.tolist()
        data["amplitude"] = one.data["amplitude"].values.tolist()
        data[how] = {
            str(case): {
                "decibel": one.decibel.sel(case=case).values.tolist(),
                "phase": one.phase.sel(case=case).values.tolist(),
            }
            for case in one.data["case"].values
        }
    return data


def _chosen(chosen: ProposedController | None) -> dict[str, Any] | None:
    if chosen is None:
        return None
    return {
        "laws": [stage.law.name for stage in chosen.controller.stages],
        "parameters": {
            r.parameter: {"value": r.value, "unit": r.unit, "why": r.why} for r in chosen.reasons
        },
    }


def _loop(loop: FeedbackLoop) -> dict[str, Any]:
    return {
        **asdict(loop),
        "crossover": loop.crossover,
        "phase_margin": loop.phase_margin,
        "largest_delay": loop.largest_delay,
    }


def _claim(claim: Claim) -> dict[str, Any]:
    return {
        "status": claim.status,
        "holds": claim.holds,
        "statement": claim.statement,
        "how": str(claim.verdict),
        "certificates": len(claim.certificates),
    }
