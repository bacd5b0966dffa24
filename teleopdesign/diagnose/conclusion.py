"""The end of a ladder: reading errors taken off, errors on the whole records, and the verdict."""

from __future__ import annotations

from dataclasses import replace

from .corrected_fit import corrected
from .decision import moment_above_noise, verdict
from .diagnosis import Diagnosis
from .error import force_error
from .error_at_command import at_command
from .fit import Fit
from .ladder_state import LadderSearch, LadderState
from .learnable import error_near_reversals, learnable
from .prepare import Prepared
from .probability import probable
from .rung import Rung
from .rungs import first_rise, without_rise


def conclude(search: LadderSearch, state: LadderState) -> Diagnosis:
    """The diagnosis that a ladder ends with."""
    prepared, floor, criteria = search.prepared, state.floor, search.criteria
    estimated = state.fit
    rungs = _with_reading_error(search, state)
    moment = moment_above_noise(rungs[-1].fit, prepared, floor, criteria=criteria)
    if prepared is not search.whole:
        search.progress("errors on the whole records")
        rungs = tuple(replace(r, fit=_on_all(r.fit, search.whole)) for r in rungs)
        if len(steady := without_rise(rungs)) < len(rungs):
            rungs, estimated = steady, steady[-1].fit
    search.progress("what could be learned")
    model = rungs[-1].fit.model
    diagnosis = Diagnosis(
        experiment=search.experiment,
        prepared=search.whole,
        verdict=verdict(rungs, floor, moment, criteria=criteria),
        rungs=rungs,
        last=state.ranking,
        estimated=estimated,
        floor=floor,
        moment=moment,
        learnable=learnable(model, search.whole, seed=search.seed),
        near_reversals=error_near_reversals(model, search.whole),
        left_out=search.plan.omissions(),
    )
    named = probable(diagnosis, criteria=criteria)
    if diagnosis.verdict == "effects_missing" and not named:
        return replace(diagnosis, verdict="undecided")
    return replace(diagnosis, named=named)


def _with_reading_error(search: LadderSearch, state: LadderState) -> tuple[Rung, ...]:
    """The rungs with the reading error removed from the last fit, unless its error grows."""
    search.progress("reading the model's own motion")
    last = corrected(search, state.fit, state.floor)
    rungs = (*state.rungs[:-1], replace(state.rungs[-1], fit=last))
    return rungs if first_rise(rungs) is None else state.rungs


def _on_all(fit: Fit, whole: Prepared) -> Fit:
    """A fit made on windows, with its errors on the whole records."""
    fit_error = force_error(fit.model, whole.of("fit"))
    check = whole.of("check")
    if not check:
        return replace(fit, fit_error=fit_error)
    error, command_error = force_error(fit.model, check), at_command(fit.model, check)
    on_whole = replace(
        fit.at_command,
        error=command_error.error,
        blind=command_error.blind,
        weak=command_error.weak,
    )
    return replace(fit, fit_error=fit_error, check_error=error, at_command=on_whole)
