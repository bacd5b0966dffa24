"""Questions that the records of a diagnosis cannot decide, each with its numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator

from ...base.finding import Finding
from ...base.sentences import join_names
from ...base.sentences import number_on_page as number
from ...base.sentences import percent_on_page as percent
from ...base.sentences import unit_on_page as unit_text
from ...base.sentences import with_error_on_page as with_error
from ...diagnose.criteria import CRITERIA
from ...diagnose.diagnosis import Diagnosis
from ...diagnose.solve import free_parameters
from ...effects import CONTACT_ROLES

#: correlation of two estimates from which they are called known only together: the standard error
#: of either is then 1/sqrt(1 - r^2) = 3.2 times what it would be if the other were known
TOGETHER = 0.95
#: most pairs of parameters that are listed
PAIRS = 6


def cannot_tell(diagnosis: Diagnosis) -> tuple[Finding, ...]:
    """Effects, parameters and candidates that the records cannot decide; may be empty."""
    parts = (
        _look_alikes,
        _on_effects,
        _on_parameters,
        _known_together,
        _on_candidates,
        _on_the_search,
    )
    return tuple(finding for part in parts for finding in part(diagnosis))


def _look_alikes(diagnosis: Diagnosis) -> Iterator[Finding]:
    """Effects that explain the records as well as one that was added."""
    for row in diagnosis.rungs:
        if row.added is None or not row.alternatives:
            continue
        topic, names = "effects that look alike", [str(row.added)]
        names += [str(one.candidate) for one in row.alternatives]
        words = f"{join_names(names)} explain these records equally well"
        apart = max(one.apart for one in row.alternatives)
        likeness = min(one.likeness for one in row.alternatives)
        if not math.isfinite(apart):  # an older answer says no more
            yield Finding(topic, "warning", f"{words}, as the answer says.")
            continue
        errors = [row.check_error, *(one.check_error for one in row.alternatives)]
        numbers = {f"check_error of {n}": error for n, error in zip(names, errors, strict=True)}
        sentence = (
            f"{words}: added at the same step they leave "
            f"{join_names([percent(error) for error in errors])}, at most {number(apart, 2)} "
            f"standard deviations of chance apart (from {CRITERIA.indistinguishable:g} on, the "
            "records would distinguish them). Along this motion they change the model's force in "
            f"the same way: the correlation is {number(likeness, 4)}."
        )
        numbers |= {"standard_deviations_apart": apart, "correlation": likeness}
        yield Finding(topic, "warning", sentence, numbers)


def _on_effects(diagnosis: Diagnosis) -> Iterator[Finding]:
    """Values that are not determined of effects that are certain, and effects set aside."""
    for one in diagnosis.undetermined:
        yield Finding("values that are not determined", "warning", f"{one}.")
    for aside in diagnosis.set_aside:
        sentence = (
            f"{aside.candidate} lowered the error to {percent(aside.check_error)} and was taken "
            f"out again: {aside.reason}."
        )
        numbers = {"check_error": aside.check_error}
        yield Finding("effects set aside", "note", sentence, numbers, aside.candidate.at)


def _on_parameters(diagnosis: Diagnosis) -> Iterator[Finding]:
    """Parameters at a bound, clocks that a delay would look like, parameters that may be zero."""
    model = diagnosis.model
    for name in diagnosis.at_bound:
        value = model.parameters[name].value
        sentence = (
            f"{name} ended at its physical bound, {number(value)}: its standard error is not "
            "valid there, and the records may not need its effect."
        )
        yield Finding("a parameter at its bound", "warning", sentence, {name: value})
    for shift in diagnosis.record_shift.values():
        if shift.at_bound or shift.is_like_a_delay:
            numbers = {"late": shift.late, "stderr": shift.stderr, "row": shift.row}
            yield Finding("clock of the logger", "note", f"{shift}.", numbers)
    for name in free_parameters(model):
        estimate = model.parameters[name]
        if name in diagnosis.at_bound or estimate.stderr < abs(estimate.value):
            continue
        why = "its effect on the force cannot be distinguished from that of the other parameters."
        if math.isfinite(estimate.stderr):
            if model.declared(name).quantity == "angle" and estimate.stderr < math.pi:
                continue
            best, error = with_error(estimate.value, estimate.stderr)
            why = f"{best} ± {error} {unit_text(model.unit(name))}: it may be zero."
        sentence = f"{name} is not determined: {why}"
        numbers = {"value": estimate.value, "stderr": estimate.stderr}
        yield Finding("a parameter left open", "note", sentence, numbers)


def _known_together(diagnosis: Diagnosis) -> Iterator[Finding]:
    """Pairs of parameters with such a correlation that only a combination of them is known."""
    known = diagnosis.last_fit.correlations.items()
    pairs = [(r, *names) for names, r in known if abs(r) > TOGETHER]
    for r, one, other in pairs[:PAIRS]:
        sentence = (
            f"{other} and {one} are known only together: their estimates have a correlation of "
            f"{number(r, 3)}, so the other makes up for a change of one."
        )
        yield Finding("parameters known only together", "note", sentence, {"correlation": r})


def _on_candidates(diagnosis: Diagnosis) -> Iterator[Finding]:
    """Candidates that the records cannot show, a curve without a law, and what was no candidate."""
    last = [(c.candidate, c.steps[-1]) for c in diagnosis.candidates if c.steps]
    if names := [str(one) for one, step in last if step is not None and not step.determined]:
        sentence = (
            f"These records do not determine {join_names(names, 'or')}: with such an effect added, "
            "its parameters could take many values, or other parameters of the model would "
            "compensate for its force."
        )
        yield Finding("effects that these records cannot show", "note", sentence)
    if (one := diagnosis.no_named_law) is not None:
        numbers = {"check_error": one.check_error, "fit_error": one.fit_error}
        yield Finding("no named law", "warning", f"{one}.", numbers, one.candidate.at)
    if reasons := _excluded_effects(diagnosis):
        sentence = (
            f"No candidates on the last step: {join_names(reasons)}. An effect is no candidate if "
            "another effect stands in its place, if it needs an effect that the model lacks, or if "
            "the motion never returns to a position, so that an effect of position cannot be "
            "distinguished from a drift over time."
        )
        yield Finding("effects that were no candidates", "note", sentence)


def _excluded_effects(diagnosis: Diagnosis) -> list[str]:
    """Effects of the catalogue that were no candidates on the last step, each with the reason."""
    model = diagnosis.model
    fitted = {
        c.candidate.key for c in diagnosis.candidates if not c.steps or c.steps[-1] is not None
    }
    reasons = []
    for place in model.places:
        body = model.body(place)
        for name, effect in model.known.items():
            of_another_kind = (place in model.bodies) == (effect.role in CONTACT_ROLES)
            if of_another_kind or body.has(name) or (name, place) in fitted:
                continue
            needs = list(body.lacks(effect))
            because = f" (needs {join_names(needs)} beside it)" if needs else ""
            reasons.append(f"{name} at {place}{because}")
    return reasons


def _on_the_search(diagnosis: Diagnosis) -> Iterator[Finding]:
    """Effects that the user excluded from the search, and a fit without a check record."""
    if diagnosis.left_out:
        exclusions = "; ".join(diagnosis.left_out)
        sentence = f"{exclusions[0].upper()}{exclusions[1:]}."
        yield Finding("left out of the search", "warning", sentence)
    if not diagnosis.experiment.check_records:
        sentence = (
            "No record was kept for checking: blocks of the fit records were held out in turn. "
            "That is no test of another motion, day or load."
        )
        yield Finding("no check record", "warning", sentence)
