"""The end of a ladder: correction of reading errors, errors on whole records, doubtful effects.

The final model holds exactly the effects that its ladder shows. Effects that are absent by the
final errors are set aside before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

from ..check import CheckedRecording, why_silent
from ..measurement.prepare import Prepared
from ..model import Model
from .error import force_error, refer_to_command
from .estimates import correct_fit
from .fit import Fit, estimate
from .free_functions import Belief, belief
from .identifiability import doubt, explains_most
from .ladder_state import LadderEnd, LadderSearch, LadderState
from .plausibility import implausible_effects
from .rung import Rung, estimate_without, first_rise, reorder_and_refit, undo, without_rise
from .search_plan import EFFORTS
from .statements import SetAside


def end_of(
    search: LadderSearch, state: LadderState, rungs: tuple[Rung, ...] | None = None
) -> LadderEnd:
    """The end of a ladder: its rungs with their errors on the whole records.

    rungs: of the state, with the reading error removed from the last fit; None: it is removed here
    """
    prepared, estimated = search.prepared, state.fit
    recording = CheckedRecording(search.experiment, state.rungs[0].fit.model, search.whole)
    rungs = with_last_corrected(search, state) if rungs is None else rungs
    if prepared is not search.whole:
        search.progress("errors on the whole records")
        rungs = tuple(replace(r, fit=_evaluate_on_all(r.fit, search.whole)) for r in rungs)
        steady = without_rise(rungs)
        if len(steady) < len(rungs):
            rungs, estimated = steady, steady[-1].fit
    accepted = {rung.added.key for rung in rungs if rung.added is not None}
    return LadderEnd(
        search=search,
        rungs=rungs,
        last=state.ranking,
        estimated=estimated,
        floor=state.floor,
        # without those that returned later, such as beside another effect
        set_aside=tuple(one for one in state.set_aside if one.candidate.key not in accepted),
        beliefs=_beliefs(rungs, prepared),
        silence=search.silence or why_silent(recording),
    )


def _beliefs(rungs: Sequence[Rung], prepared: Prepared) -> dict[tuple[str, str], Belief]:
    """What each effect of the final model explains beside free functions, as if it came last."""
    last, beliefs = rungs[-1].fit, {}
    for rung in rungs[1:]:
        model = _without_effect_of(rung, rungs)
        if model is None or rung.added is None:
            continue
        without = estimate(model, prepared, effort=EFFORTS.continued)
        beliefs[rung.added.key] = belief(without, last, rung.added.at, prepared)
    return beliefs


def _without_effect_of(rung: Rung, rungs: Sequence[Rung]) -> Model | None:
    """The final model without the effect of a rung, and without those that need it.

    returns: None where an effect of the user's model needs it
    """
    model = rungs[-1].fit.model
    later = rungs[rungs.index(rung) + 1 :]
    for gone in ([], *([other] for other in reversed(later)), [*reversed(later)]):
        without = undo([*gone, rung], model)
        if without is not None:
            return without
    return None


def find_doubtful_rung(
    rungs: Sequence[Rung], prepared: Prepared, estimated: Fit
) -> tuple[Rung, str] | None:
    """The last rung whose effect is uncertain or implausible in the final fit, with the reason.

    estimated: the final fit before its standard errors included those of the readings
    """
    last = rungs[-1].fit
    stands_for = implausible_effects(last.model, prepared) if len(rungs) > 1 else {}
    for before, rung in reversed(list(pairwise(rungs))):
        assert rung.added is not None
        if not last.model.body(rung.added.at).has(rung.added.effect.name):
            continue
        most = estimated if explains_most(before.fit, rung.fit) else None
        why = stands_for.get(rung.added.key) or doubt(last, rung.added, most=most)
        if why:
            return rung, why
    return None


def _find_dependent(rungs: Sequence[Rung], rung: Rung, why: str) -> tuple[Rung, str] | None:
    """The last rung whose effect needs that of another rung, with the reason; None: none does.

    why: the doubt about the other rung
    """
    model = rungs[-1].fit.model
    if undo([rung], model) is not None:
        return None
    others = (r for r in reversed(rungs) if r.added not in (None, rung.added))
    other = next((r for r in others if undo([r, rung], model) is not None), None)
    return None if other is None else (other, f"it needs {rung.added}: {why}")


def remove_doubtful_rung(
    search: LadderSearch, state: LadderState, rungs: Sequence[Rung]
) -> LadderState | None:
    """The ladder without the last effect that is doubtful at its end.

    An effect that needs the doubtful one goes first.

    rungs: of the state, with the errors that the answer would state
    returns: None where no effect is doubtful, or the effect was removed before
    """
    doubted = find_doubtful_rung(rungs, search.prepared, state.fit)
    if doubted is None:
        return None
    rung, why = _find_dependent(state.rungs, *doubted) or doubted
    assert rung.added is not None
    fewer = [r for r in state.rungs if r.added != rung.added]
    without = estimate_without(state.fit.model, rung, search.prepared)
    if rung.added.key in state.gone or without is None:
        return None
    order = reorder_and_refit(fewer, without, search.prepared)
    if order is None:
        return None
    aside = SetAside(rung.added, rung.fit.check_error, why)
    search.progress(f"set aside: {aside}")
    return replace(state.with_rungs(order), set_aside=(*state.set_aside, aside))


def estimable_on_all(prepared: Prepared) -> Prepared | None:
    """All records, each as a fit record and for comparison; None: no check records.

    None for an arm's joints too: their shared link parameters belong to the fit records.
    """
    if not prepared.of("check") or prepared.is_linked:
        return None
    records = (*prepared.of("fit"), *prepared.of("check"))
    both = (replace(s, use=use) for use in ("fit", "check") for s in records)
    return Prepared(prepared.experiment, prepared.bandwidth, tuple(both))


def check_error_on_all(fit: Fit, prepared: Prepared) -> float | None:
    """Check error of a model estimated on all records; None as in `estimable_on_all`."""
    together = estimable_on_all(prepared)
    if together is None:
        return None
    return force_error(estimate(fit.model, together).model, prepared.of("check"))


def with_last_corrected(search: LadderSearch, state: LadderState) -> tuple[Rung, ...]:
    """The rungs with the reading error removed from the last fit, unless an error then rises."""
    search.progress("reading the model's own motion")
    last = correct_fit(search, state.fit, state.floor)
    rungs = (*state.rungs[:-1], replace(state.rungs[-1], fit=last))
    return rungs if first_rise(rungs) is None else state.rungs


def _evaluate_on_all(fit: Fit, whole: Prepared) -> Fit:
    """A fit made on windows, with its errors evaluated on the whole records."""
    fit_error = force_error(fit.model, whole.of("fit"))
    check = whole.of("check")
    if not check:
        return replace(fit, fit_error=fit_error)
    error, command_error = force_error(fit.model, check), refer_to_command(fit.model, check)
    on_whole = replace(
        fit.at_command,
        error=command_error.error,
        blind=command_error.blind,
    )
    return replace(fit, fit_error=fit_error, check_error=error, at_command=on_whole)
