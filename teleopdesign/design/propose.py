"""From an identified body to controllers, predictions and claims."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from ..base.errors import ModelError
from ..block_cuts import BlockDiagnosis
from ..blocks import Body, free_space
from ..diagnose import Diagnosis
from ..diagrams import Diagram, four_cases, haptic_interface
from ..model import Model
from ..passivity import Claim
from ..passivity.claims.claim import use_units_of
from ..realise.damping_interval import small_motion_damping
from ..realise.friction_interval import FrictionInterval, friction_interval
from ..realise.reach import Reach
from .assumptions import (
    Assumptions,
    StatedMotion,
    device_of_diagram,
    reach_of,
    sampling_of,
    stated_motion,
)
from .cancellation import (
    ProposedController,
    acting_gain,
    cancelled_level,
    dahl_cancellation,
    smoothed_cancellation,
    smoothing_name,
)
from .expected import ExpectedError, expected_error, unexplained_force
from .force_feedback import FeedbackLoop, force_feedback, identified_delay, whole_inertia
from .linear import transparency
from .other_effects import (
    following_cancellation,
    late_force_claim,
    not_cancelled,
    with_forces,
    with_gains_divided_out,
)
from .outcome import Design
from .prediction import Prediction, felt_impedance, predict
from .quasi_static import SHARES, residual_friction
from .verdict import cancellation_claims, compliant_claim, energy_claim, feedback_claim

#: load of a hand over the inertia of the device, if no load is stated
LOAD = 3.0
#: bandwidth of the velocity filter if none is stated: the smaller of FILTER (Hz) and FILTER_SHARE
#: times the sample rate
FILTER, FILTER_SHARE = 50.0, 0.1


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
    body = free_space(diagnosis.model.body(at))
    settings = complete_assumptions(assumptions or Assumptions(), body, reach)
    motion = stated_motion(reach, settings, body.axis)
    friction = friction_interval(body, reach, errors=settings.errors)
    options: list[ProposedController | None] = [*cancellations(body, friction, reach, settings)]
    trials = [_trial(body, one, motion, reach, settings) for one in options or [None]]
    best = min(trials, key=lambda t: t.left)
    covariance, sampling = diagnosis.covariance({"Z_M": at}), sampling_of(settings, reach)
    others = [t for t in trials if t is not best]
    return Design(
        experiment=diagnosis.experiment.title or diagnosis.experiment.folder.name,
        place=at,
        body=body,
        assumptions=settings,
        reach=reach,
        friction=friction,
        cancellation=best.cancellation,
        other=others[0].cancellation if others else None,
        other_left=others[0].left if others else float("nan"),
        force_feedback=best.force_feedback,
        loop=best.loop,
        prediction=best.prediction,
        expected=_error_to_expect(best, diagnosis, at, settings, reach),
        not_cancelled=not_cancelled(body, best.cancellation),
        impedance=felt_impedance(best.prediction.hybrid, motion, sampling, covariance),
        residual=residual_friction(
            body,
            cancellation=best.friction.controller if best.friction else None,
            force_feedback=best.force_feedback.controller,
            speeds=reach.peak_speed * SHARES,
            position=motion.centre,
        ),
        transparency=transparency(_with_load(best, body, settings), motion, covariance),
        claims=_claims(best, body, friction, reach, settings),
        verdict=diagnosis.verdict,
        left=diagnosis.left,
    )


def _error_to_expect(
    best: Trial, diagnosis: Diagnosis, at: str, settings: Assumptions, reach: Reach
) -> ExpectedError:
    """The force error of what can be built with the recorded sensors."""
    case = "hybrid" if reach.measures_force else "MBC" if best.cancellation else "none"
    cases, error = best.prediction.cases, diagnosis.after.check_error
    floor = error / max(diagnosis.left, 1.0)
    return expected_error(
        case,
        four_cases(best.prediction.hybrid, every=True)[case],
        best.prediction.motion,
        sampling_of(settings, reach),
        simulated=cases[case].simulated,
        without=cases["none"].simulated,
        unexplained=unexplained_force(diagnosis.experiment, at, error=error, floor=floor),
    )


def complete_assumptions(assumptions: Assumptions, body: Body, reach: Reach) -> Assumptions:
    """The assumptions, with missing ones derived from the record and the body."""
    period = assumptions.sample_period or reach.sample_period
    mass = whole_inertia(body)
    delay = period if assumptions.delay is None else assumptions.delay
    filtered = assumptions.velocity_bandwidth or min(FILTER, FILTER_SHARE / period)
    load = assumptions.load or float(f"{LOAD * mass:.2g}")
    return replace(
        assumptions, sample_period=period, delay=delay, velocity_bandwidth=filtered, load=load
    )


def cancellations(
    body: Body, friction: FrictionInterval | None, reach: Reach, assumptions: Assumptions
) -> list[ProposedController]:
    """The laws for C that are passive within all intervals; none if no level is certain."""
    if friction is None:
        return []
    gain = command_gain(body, reach, errors=assumptions.errors)
    level = cancelled_level(friction, body, reach, gain, assumptions)
    if level is None:
        return []
    damping = small_motion_damping(body, errors=assumptions.errors)
    late = _total_delay(body, assumptions)
    dahl = dahl_cancellation(
        level, friction, reach, gain, assumptions, axis=body.axis, late=late, damping=damping
    )
    laws = [] if dahl is None else [dahl]
    if friction.presliding is not None:
        # in small motion a smoothed cancellation is a negative damper that a bristle cannot stop
        return laws
    assert assumptions.sample_period is not None and assumptions.velocity_bandwidth is not None
    smoothed = smoothed_cancellation(
        level,
        reach,
        assumptions,
        axis=body.axis,
        period=assumptions.sample_period,
        filter_bandwidth=assumptions.velocity_bandwidth,
    )
    follows = following_cancellation(smoothed, body, reach, assumptions, gain=gain)
    return [*laws, smoothed if follows is None else follows]


def command_gain(body: Body, reach: Reach, *, errors: float) -> float:
    """Upper bound of the acting force per commanded force, once C has divided its gains out."""
    rest, ratio = with_gains_divided_out(body, reach=reach, errors=errors)
    return ratio * acting_gain(rest, reach, errors=errors)


def _trial(
    body: Body,
    option: ProposedController | None,
    motion: StatedMotion,
    reach: Reach,
    assumptions: Assumptions,
) -> Trial:
    assert (
        assumptions.load is not None
        and assumptions.sample_period is not None
        and assumptions.delay is not None
    )
    whole = with_forces(option, body, assumptions)
    names = whole.controller.names() if whole else {}
    smoothing = smoothing_name(names)
    h, loop = force_feedback(
        body,
        reach,
        assumptions,
        load=assumptions.load,
        # the command is held for a sample, and so is the error that the low-pass takes in
        delay=_total_delay(body, assumptions) + assumptions.sample_period,
        smoothing_velocity=0.0 if smoothing is None else names[smoothing],
    )
    diagram, linear = (
        haptic_interface(
            body,
            cancellation=one.controller if one else None,
            force_feedback=h.controller,
        )
        for one in (whole, option)
    )
    sampling = sampling_of(assumptions, reach)
    prediction = predict(diagram, motion, sampling, linear=linear)
    return Trial(option, whole, h, loop, diagram, prediction)


def _total_delay(body: Body, assumptions: Assumptions) -> float:
    """Computing delay plus the delay of the identified actuation, s."""
    assert assumptions.delay is not None
    return assumptions.delay + identified_delay(body)


def _with_load(best: Trial, body: Body, assumptions: Assumptions) -> Diagram:
    """The diagram with the load in place of the hand."""
    assert assumptions.load is not None
    inertia = replace(body.parameters["inertia"], value=assumptions.load)
    return haptic_interface(
        body,
        hand=Body(body.axis, {"inertia": inertia}),
        cancellation=best.friction.controller if best.friction else None,
        force_feedback=best.force_feedback.controller,
    )


def _claims(
    best: Trial,
    body: Body,
    friction: FrictionInterval | None,
    reach: Reach,
    assumptions: Assumptions,
) -> Mapping[str, tuple[Claim, ...]]:
    """The claims on passivity of each case."""
    by_case: dict[str, list[Claim]] = {case: [] for case in four_cases(best.diagram, every=True)}
    late = _total_delay(body, assumptions)
    if best.friction is not None and friction is not None:
        gain = command_gain(body, reach, errors=assumptions.errors)
        by_case["MBC"] = cancellation_claims(
            body,
            best.friction,
            friction,
            reach,
            gain=gain,
            late=late,
            errors=assumptions.errors,
            fraction=assumptions.fraction,
        )
        compliant = compliant_claim(body, best.friction, friction, gain=gain)
        by_case["MBC"] += [compliant] if compliant is not None else []
    assert assumptions.sample_period is not None
    held = late + assumptions.sample_period
    if (of_place := late_force_claim(body, reach, assumptions, late=held)) is not None:
        by_case["MBC"].append(of_place)
    by_case["FF"] = [feedback_claim(body, best.force_feedback.controller)]
    sampling = sampling_of(assumptions, reach)
    for case, diagram in four_cases(best.prediction.hybrid, every=True).items():
        claim = energy_claim(diagram, best.prediction.motion, reach, sampling, axis=body.axis)
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
