"""From an identified body to controllers, predictions and claims."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..base.errors import ModelError
from ..base.sentences import join_names
from ..block_cuts import BlockDiagnosis
from ..blocks import Body, free_space
from ..diagnose import Diagnosis
from ..diagrams import Diagram, four_cases, haptic_interface
from ..model import Model
from ..passivity import Claim
from ..passivity.claims.claim import use_units_of
from .assumptions import Assumptions, device_of_diagram, reach_of
from .cancellation import (
    ProposedController,
    cancelled_level,
    dahl_cancellation,
    smoothed_cancellation,
    smoothing_name,
)
from .device import Device
from .expected import ExpectedError, expected_error, unexplained_force
from .force_feedback import FeedbackLoop, force_feedback
from .linear import first_harmonic, transparency
from .other_effects import (
    following_cancellation,
    forces_to_cancel,
    late_force_claim,
    not_cancelled,
    with_forces,
)
from .outcome import Design
from .prediction import Prediction, felt_impedance, predict
from .quasi_static import SHARES, residual_friction
from .verdict import cancellation_claims, compliant_claim, energy_claim, feedback_claim


@dataclass(frozen=True)
class Trial:
    """One choice of C with its H, and the force error predicted for both.

    friction: the part of C that cancels friction, alone
    """

    friction: ProposedController | None
    cancellation: ProposedController | None
    force_feedback: ProposedController
    loop: FeedbackLoop
    diagram: Diagram
    prediction: Prediction

    @property
    def left(self) -> float:
        """Rms force error of the hybrid in simulation; inf if it cannot be simulated."""
        case = self.prediction.cases["hybrid"]
        return float("inf") if case.failed else case.simulated


def design(
    diagnosis: Diagnosis | BlockDiagnosis,
    *,
    place: str | None = None,
    assumptions: Assumptions | None = None,
) -> Design:
    """Propose cancellation C and force feedback H for an identified body; predict their effect.

    diagnosis: computed now, or read from its answer by `load_answer`; of a whole diagram, its
        computer's delay and its hand take the place of assumptions
    place: which body; may be omitted if there is only one
    Of the laws for C that are certain to be passive, the design has the one with the smaller force
    error.
    raises ModelError: no such body, an assumption that cannot hold, a motion beyond the records

        >>> diagnosis = td.find_missing(td.load_experiment(td.example("rod")), among=["stribeck"])
        >>> td.design_compensation(diagnosis).cancellation.controller.names()
        {'dahl.level': 0.491, 'dahl.stiffness': 6810.0}
    """
    if isinstance(diagnosis, BlockDiagnosis):
        diagnosis, place, assumptions = device_of_diagram(diagnosis, place, assumptions)
    at = _place(diagnosis.model, place)
    reach = reach_of(diagnosis.experiment, at)
    device = Device(free_space(diagnosis.model.body(at)), reach, assumptions or Assumptions())
    motion = device.motion
    trials = [_trial(device, one) for one in cancellations(device) or [None]]
    best = min(trials, key=lambda t: t.left)
    covariance = diagnosis.covariance({"Z_M": at})
    others = [t for t in trials if t is not best]
    return Design(
        experiment=diagnosis.experiment.title or diagnosis.experiment.folder.name,
        place=at,
        body=device.body,
        assumptions=device.assumptions,
        reach=reach,
        friction=device.friction,
        cancellation=best.cancellation,
        other=others[0].cancellation if others else None,
        other_left=others[0].left if others else float("nan"),
        force_feedback=best.force_feedback,
        loop=best.loop,
        prediction=best.prediction,
        expected=_error_to_expect(best, diagnosis, at, device),
        not_cancelled=not_cancelled(device, best.cancellation),
        impedance=felt_impedance(best.prediction.hybrid, motion, device.sampling, covariance),
        residual=residual_friction(
            device.body,
            cancellation=best.friction.controller if best.friction else None,
            force_feedback=best.force_feedback.controller,
            speeds=reach.peak_speed * SHARES,
            position=motion.centre,
        ),
        transparency=transparency(_with_load(best, device), motion, covariance),
        claims=_claims(best, device),
        verdict=diagnosis.verdict,
        left=diagnosis.left,
    )


def _error_to_expect(best: Trial, diagnosis: Diagnosis, at: str, device: Device) -> ExpectedError:
    """The force error of what can be built with the recorded sensors."""
    case = "hybrid" if device.reach.measures_force else "MBC" if best.cancellation else "none"
    cases, error = best.prediction.cases, diagnosis.after.check_error
    floor = error / max(diagnosis.left, 1.0)
    return expected_error(
        case,
        four_cases(best.prediction.hybrid, every=True)[case],
        device.motion,
        device.sampling,
        simulated=cases[case].simulated,
        without=cases["none"].simulated,
        unexplained=unexplained_force(diagnosis.experiment, at, error=error, floor=floor),
    )


def cancellations(device: Device) -> list[ProposedController | None]:
    """The laws for C that are passive within all intervals; none if no level is certain."""
    level = cancelled_level(device)
    if device.friction is None or level is None:
        return []
    dahl = dahl_cancellation(level, device)
    laws: list[ProposedController | None] = [] if dahl is None else [dahl]
    if device.friction.presliding is not None:
        # in small motion a smoothed cancellation is a negative damper that a bristle cannot stop
        return laws
    smoothed = smoothed_cancellation(level, device)
    return [*laws, following_cancellation(smoothed, device) or smoothed]


def _trial(device: Device, option: ProposedController | None) -> Trial:
    whole = with_forces(option, device)
    names = whole.controller.names() if whole else {}
    smoothing = smoothing_name(names)
    h, loop = force_feedback(
        device, smoothing_velocity=0.0 if smoothing is None else names[smoothing]
    )
    diagram, of_friction = (
        haptic_interface(
            device.body,
            cancellation=one.controller if one else None,
            force_feedback=h.controller,
        )
        for one in (whole, option)
    )
    has_harmonic = not whole or first_harmonic(whole.controller, device.motion) is not None
    linear = diagram if has_harmonic else of_friction
    prediction = predict(diagram, device.motion, device.sampling, linear=linear)
    if whole and not has_harmonic:
        gone = f"C of {join_names(list(forces_to_cancel(device)))}"
        left_out = ", ".join(filter(None, [prediction.left_out, gone]))
        prediction = replace(prediction, left_out=left_out)
    return Trial(option, whole, h, loop, diagram, prediction)


def _with_load(best: Trial, device: Device) -> Diagram:
    """The diagram with the load in place of the hand."""
    body = device.body
    inertia = replace(body.parameters["inertia"], value=device.load)
    return haptic_interface(
        body,
        hand=Body(body.axis, {"inertia": inertia}),
        cancellation=best.friction.controller if best.friction else None,
        force_feedback=best.force_feedback.controller,
    )


def _claims(best: Trial, device: Device) -> Mapping[str, tuple[Claim, ...]]:
    """The claims on passivity of each case."""
    body = device.body
    by_case: dict[str, list[Claim]] = {case: [] for case in four_cases(best.diagram, every=True)}
    if best.friction is not None:
        by_case["MBC"] = cancellation_claims(device, best.friction)
        compliant = compliant_claim(device, best.friction)
        by_case["MBC"] += [compliant] if compliant is not None else []
    if (of_place := late_force_claim(device)) is not None:
        by_case["MBC"].append(of_place)
    by_case["FF"] = [feedback_claim(body, best.force_feedback.controller)]
    for case, diagram in four_cases(best.prediction.hybrid, every=True).items():
        claim = energy_claim(diagram, device.motion, device.reach, device.sampling, axis=body.axis)
        by_case[case].append(claim)
    return {
        case: tuple(use_units_of(body.axis, c) for c in claims) for case, claims in by_case.items()
    }


def _place(model: Model, place: str | None) -> str:
    if place is None and len(model.bodies) > 1:
        raise ModelError(f"design: body: one of {', '.join(model.bodies)} must be given")
    at = next(iter(model.bodies)) if place is None else place
    model.body(at)
    return at
