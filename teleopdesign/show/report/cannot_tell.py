"""Questions that the records of a diagnosis cannot decide, each with its numbers."""

from __future__ import annotations

import math

from ...base.finding import Finding
from ...base.sentences import join_names
from ...base.sentences import number_on_page as number
from ...base.sentences import percent_on_page as percent
from ...base.sentences import unit_on_page as unit_text
from ...base.sentences import with_error_on_page as with_error
from ...diagnose.criteria import CRITERIA
from ...diagnose.diagnosis import Diagnosis
from ...diagnose.fit import Fit
from ...diagnose.solve import free_parameters
from ...diagnose.statements import LadderRow
from ...effects import CONTACT_ROLES

#: correlation of two estimates from which they are called known only together: the standard error
#: of either is then 1/sqrt(1 - r^2) = 3.2 times what it would be if the other were known
TOGETHER = 0.95
#: most pairs of parameters that are listed
PAIRS = 6


def cannot_tell(diagnosis: Diagnosis) -> tuple[Finding, ...]:
    """Effects, parameters and candidates that the records cannot decide; may be empty."""
    groups = [_group(r) for r in diagnosis.rungs if r.added is not None and r.alternatives]
    rest = [
        *_list_undetermined(diagnosis),
        *_set_aside(diagnosis),
        *_findings_at_bound(diagnosis),
        *_clock(diagnosis),
        *_open_parameters(diagnosis),
        *_find_correlated(diagnosis.last_fit),
        *_open_candidates(diagnosis),
        *_no_named_law(diagnosis),
        *_excluded_effects(diagnosis),
        *_findings_on_exclusions(diagnosis),
        *_findings_unchecked(diagnosis),
    ]
    return (*groups, *rest)


def _list_undetermined(diagnosis: Diagnosis) -> list[Finding]:
    """Parameters without a determined value, of effects that are certain."""
    return [
        Finding("values that are not determined", "warning", f"{one}.")
        for one in diagnosis.undetermined
    ]


def _set_aside(diagnosis: Diagnosis) -> list[Finding]:
    """Effects that lowered the error but were removed from the model again."""
    return [
        Finding(
            topic="effects set aside",
            concern="note",
            sentence=f"{one.candidate} lowered the error to {percent(one.check_error)} and was "
            f"taken out again: {one.reason}.",
            numbers={"check_error": one.check_error},
            where=one.candidate.at,
        )
        for one in diagnosis.set_aside
    ]


def _no_named_law(diagnosis: Diagnosis) -> list[Finding]:
    """The curve that leaves less than the final model, and explains nothing."""
    one = diagnosis.no_named_law
    if one is None:
        return []
    numbers = {"check_error": one.check_error, "fit_error": one.fit_error}
    return [Finding("no named law", "warning", f"{one}.", numbers, one.candidate.at)]


def _clock(diagnosis: Diagnosis) -> list[Finding]:
    """Time shifts between force and position in the records, if a delay would look the same."""
    return [
        Finding(
            topic="clock of the logger",
            concern="note",
            sentence=f"{shift}.",
            numbers={"late": shift.late, "stderr": shift.stderr, "row": shift.row},
        )
        for shift in diagnosis.record_shift.values()
        if shift.at_bound or shift.is_like_a_delay
    ]


def _group(row: LadderRow) -> Finding:
    names = [str(row.added), *(str(one.candidate) for one in row.alternatives)]
    apart = max(one.apart for one in row.alternatives)
    likeness = min(one.likeness for one in row.alternatives)
    if not math.isfinite(apart):  # an older answer says no more
        return Finding(
            topic="effects that look alike",
            concern="warning",
            sentence=f"{join_names(names)} explain these records equally well, as the answer says.",
        )
    errors = [row.check_error, *(one.check_error for one in row.alternatives)]
    numbers = {f"check_error of {n}": error for n, error in zip(names, errors, strict=True)}
    return Finding(
        topic="effects that look alike",
        concern="warning",
        sentence=(
            f"{join_names(names)} explain these records equally well: added at the same step they "
            f"leave {join_names([percent(error) for error in errors])}, at most "
            f"{number(apart, 2)} standard deviations of chance apart (from "
            f"{CRITERIA.indistinguishable:g} on, the records would distinguish them). Along this "
            "motion they change the model's force in the same way: the correlation is "
            f"{number(likeness, 4)}."
        ),
        numbers=numbers | {"standard_deviations_apart": apart, "correlation": likeness},
    )


def _findings_at_bound(diagnosis: Diagnosis) -> list[Finding]:
    findings = []
    for name in diagnosis.at_bound:
        value = diagnosis.model.parameters[name].value
        findings.append(
            Finding(
                topic="a parameter at its bound",
                concern="warning",
                sentence=(
                    f"{name} ended at its physical bound, {number(value)}: its standard error is "
                    "not valid there, and the records may not need its effect."
                ),
                numbers={name: value},
            )
        )
    return findings


def _open_parameters(diagnosis: Diagnosis) -> list[Finding]:
    findings = []
    model = diagnosis.model
    for name in free_parameters(model):
        value = model.parameters[name]
        if name in diagnosis.at_bound or value.stderr < abs(value.value):
            continue
        if math.isfinite(value.stderr):
            angle = model.declared(name).quantity == "angle"
            if angle and value.stderr < math.pi:
                continue
            best, error = with_error(value.value, value.stderr)
            why = f"{best} ± {error} {unit_text(model.unit(name))}: it may be zero."
        else:
            why = (
                "its effect on the force cannot be distinguished from that of the other parameters."
            )
        findings.append(
            Finding(
                topic="a parameter left open",
                concern="note",
                sentence=f"{name} is not determined: {why}",
                numbers={"value": value.value, "stderr": value.stderr},
            )
        )
    return findings


def _find_correlated(fit: Fit) -> list[Finding]:
    """Pairs of parameters with such a correlation that only a combination of them is known."""
    pairs = [(r, *names) for names, r in fit.correlations.items() if abs(r) > TOGETHER]
    return [
        Finding(
            topic="parameters known only together",
            concern="note",
            sentence=(
                f"{other} and {one} are known only together: their estimates have a correlation of "
                f"{number(r, 3)}, so the other makes up for a change of one."
            ),
            numbers={"correlation": r},
        )
        for r, one, other in pairs[:PAIRS]
    ]


def _open_candidates(diagnosis: Diagnosis) -> list[Finding]:
    last = [(c.candidate, c.steps[-1]) for c in diagnosis.candidates if c.steps]
    names = [str(one) for one, step in last if step is not None and not step.determined]
    if not names:
        return []
    return [
        Finding(
            topic="effects that these records cannot show",
            concern="note",
            sentence=(
                f"These records do not determine {join_names(names, 'or')}: with such an effect "
                "added, its parameters could take many values, or other parameters of the model "
                "would compensate for its force."
            ),
        )
    ]


def _excluded_effects(diagnosis: Diagnosis) -> list[Finding]:
    """Effects of the catalogue that could not be candidates on the last step."""
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
    if not reasons:
        return []
    return [
        Finding(
            topic="effects that were no candidates",
            concern="note",
            sentence=(
                f"No candidates on the last step: {join_names(reasons)}. An effect is no "
                "candidate if another effect stands in its place, if it needs an effect that the "
                "model lacks, or if the motion never returns to a position, so that an effect of "
                "position cannot be distinguished from a drift over time."
            ),
        )
    ]


def _findings_on_exclusions(diagnosis: Diagnosis) -> list[Finding]:
    """Effects that the user excluded from the search."""
    if not diagnosis.left_out:
        return []
    exclusions = "; ".join(diagnosis.left_out)
    return [
        Finding("left out of the search", "warning", f"{exclusions[0].upper()}{exclusions[1:]}.")
    ]


def _findings_unchecked(diagnosis: Diagnosis) -> list[Finding]:
    if diagnosis.experiment.check_records:
        return []
    return [
        Finding(
            topic="no check record",
            concern="warning",
            sentence=(
                "No record was kept for checking: blocks of the fit records were held out in turn. "
                "That is no test of another motion, day or load."
            ),
        )
    ]
