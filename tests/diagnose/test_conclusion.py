"""What the end of a ladder makes of its rungs: kept, set aside, named, or said to be open."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import pytest
from diagnose.stand_ins import Leaves, fit, floor, ranked
from diagnose.stub_models import Table, candidate

from teleopdesign.diagnose import conclusion as module
from teleopdesign.diagnose import rungs as rungs_module
from teleopdesign.diagnose.conclusion import (
    conclude,
    find_doubtful_rung,
    remove_doubtful_rung,
    with_last_corrected,
)
from teleopdesign.diagnose.fit import CommandError, Fit
from teleopdesign.diagnose.ranking import Ranking
from teleopdesign.diagnose.rung import Rung
from teleopdesign.diagnose.statements import SetAside
from teleopdesign.diagnose.verdict import verdict

SPRING, BIAS, DRAG = EVERY = tuple(map(candidate, ("spring", "bias", "quadratic_drag")))
LOW = floor(0.01)


def error(names):
    """A spring and a bias are missing; drag is next to nothing."""
    return (
        1.0
        - 0.6 * ("spring" in names)
        - 0.385 * ("bias" in names)
        - 1e-4 * ("quadratic_drag" in names)
    )


def ladder(table, *effects):
    rungs = table.rungs(*effects)
    return [rungs[0]] + [
        replace(r, ranking=table.rank(before.fit, among=EVERY)) for before, r in pairwise(rungs)
    ]


def worse(fit, by=2.0, **at_command):
    """The fit with other figures, as the whole records show it."""
    command = SimpleNamespace(**{**vars(fit.at_command), **at_command})
    return Leaves(**{**vars(fit), "check_error": by * fit.check_error, "at_command": command})


@pytest.fixture
def concluded(monkeypatch):
    """The diagnosis that rungs end with; on the whole records each fit is what `on_whole` makes.

    What would be learned, read or drawn again of records is left out: there are none.
    """

    def run(rungs, *, on_whole=None, set_aside=()):
        table = Table(error)
        stubs = {
            "learnable": lambda *_, **__: None,
            "repeatability": lambda *_, **__: None,
            "find_undetermined": lambda *_: (),
            "_beliefs": lambda *_: {},
            "check_error_on_all": lambda *_: None,
            "free_form": lambda *_: None,
            "error_near_reversals": lambda model, _: model,  # to show of which model it is
        }
        for name, value in stubs.items():
            monkeypatch.setattr(module, name, value)
        monkeypatch.setattr(module, "why_silent", lambda *_: "")
        monkeypatch.setattr(module, "_evaluate_on_all", lambda fit, whole: on_whole(fit))
        search, windows = table.search(), object()
        search.whole = SimpleNamespace(is_curve=False)
        search.prepared = windows if on_whole else search.whole
        search.experiment, search.seed = None, 0
        search.progress = lambda line: None
        search.generator = lambda: None
        search.plan.omissions = lambda: ()
        state = table.state(rungs, set_aside=set_aside)
        return conclude(search, state, tuple(rungs)), state

    return run


def added(diagnosis):
    return [r.added for r in diagnosis.rungs[1:]]


def test_what_holds_on_the_whole_records_is_kept_with_the_fit_that_was_sought(concluded):
    rungs = ladder(Table(error), "spring", "bias")
    diagnosis, state = concluded(rungs, on_whole=lambda fit: worse(fit, 1.1))
    assert added(diagnosis) == [SPRING, BIAS] and diagnosis.set_aside == ()
    assert diagnosis.after.check_error == pytest.approx(1.1 * rungs[-1].fit.check_error)
    assert diagnosis.estimated is state.fit is rungs[-1].fit
    assert diagnosis.verdict == "effects_missing" and diagnosis.named == (SPRING, BIAS)
    assert diagnosis.near_reversals is diagnosis.after.model is rungs[-1].fit.model


def test_a_rung_that_leaves_more_of_the_whole_records_is_left_out(concluded):
    rungs = ladder(Table(error), "spring", "bias", "quadratic_drag")
    last = rungs[-1].fit

    def on_whole(fit):
        return worse(fit, 100.0 if fit is last else 1.0)

    diagnosis, _ = concluded(rungs, on_whole=on_whole)
    assert added(diagnosis) == [SPRING, BIAS] and diagnosis.set_aside == ()
    assert diagnosis.estimated is diagnosis.after
    assert diagnosis.after.model is diagnosis.near_reversals is rungs[2].fit.model


def test_the_answer_sets_no_effect_of_its_ladder_aside(concluded):
    """Alone it only weakened errors of the readings, beside another one it explained the force."""
    aside = tuple(SetAside(one, 0.5, "alone it explains nothing") for one in (SPRING, DRAG))
    diagnosis, _ = concluded(ladder(Table(error), "bias", "spring"), set_aside=aside)
    assert added(diagnosis) == [BIAS, SPRING]
    assert diagnosis.set_aside == aside[1:]


def test_records_that_were_searched_as_a_whole_are_not_evaluated_again(concluded):
    rungs = ladder(Table(error), "spring", "bias")
    diagnosis, _ = concluded(rungs)
    assert [r.fit for r in diagnosis.rungs] == [r.fit for r in rungs]


def test_effects_none_of_which_is_probable_are_not_missing_surely(concluded):
    def far(fit):  # much more than noise is left, and much of it before
        return worse(fit, 30.0)

    rungs = ladder(Table(lambda names: 0.033 * (1.0 - 0.35 * ("spring" in names))), "spring")
    diagnosis, _ = concluded(rungs, on_whole=far)
    assert diagnosis.verdict == "undecided" and diagnosis.named == ()
    assert verdict(diagnosis.rungs, diagnosis.floor) == "effects_missing"


def test_a_model_that_leaves_noise_stays_adequate_without_a_name(concluded):
    rungs = ladder(Table(lambda names: 0.015))
    diagnosis, _ = concluded(rungs)
    assert diagnosis.verdict == "model_adequate" and diagnosis.named == ()
    assert [r.could_be for r in diagnosis.rungs] == [None]


def unnamed(rung, named=()):
    return module._leave_unnamed(rung, named)


def test_what_is_not_named_says_what_else_would_do_half_as_much():
    base = Table(lambda names: 1.0).fit()
    best, good = ranked(0.5), ranked(0.6, "spring")
    weak = ranked(0.9, "viscous")
    rung = Rung(best.candidate, best.fit, Ranking(base, (best, good, weak)))
    assert unnamed(rung).could_be == (good.candidate,)
    assert unnamed(replace(rung, added=good.candidate)).could_be == (best.candidate,)
    # what is named, stands for a group, or says so already stays as it is
    assert unnamed(rung, [best.candidate]) is rung
    group = replace(rung, alternatives=(good.candidate,))
    assert unnamed(group) is group
    last_rung = replace(rung, could_be=())
    assert unnamed(last_rung) is last_rung
    model = Rung(None, base)
    assert unnamed(model) is model
    without = replace(rung, ranking=None)
    assert unnamed(without) is without
    elsewhere = replace(rung, added=BIAS)
    assert unnamed(elsewhere) is elsewhere


@pytest.fixture
def doubts(monkeypatch):
    """What is said of effects at the end: by their files, and by the stated errors."""

    def say(by_file=(), by_errors=()):
        by_file, by_errors = dict(by_file), dict(by_errors)
        monkeypatch.setattr(
            module,
            "implausible_effects",
            lambda model, prepared: {c.key: w for c, w in by_file.items()},
        )
        monkeypatch.setattr(module, "doubt", lambda fit, c, **_: by_errors.get(c, ""))

    return say


def doubtful(rungs):
    return find_doubtful_rung(rungs, None, rungs[-1].fit)


def test_the_last_effect_that_is_doubtful_is_named_with_the_reason(doubts):
    rungs = ladder(Table(error), "spring", "bias", "quadratic_drag")
    doubts()
    assert doubtful(rungs) is None
    doubts({SPRING: "a bristle"})
    assert doubtful(rungs) == (rungs[1], "a bristle")
    assert doubtful(rungs[:2]) == (rungs[1], "a bristle")
    doubts({SPRING: "a bristle"}, {BIAS: "not told from absence", SPRING: "no"})
    assert doubtful(rungs) == (rungs[2], "not told from absence")
    assert doubtful(rungs[:2]) == (rungs[1], "a bristle")
    assert doubtful(rungs[:1]) is None


def test_what_the_last_model_has_no_more_is_not_doubted(doubts):
    rungs = ladder(Table(error), "spring", "bias")
    gone = replace(rungs[-1], fit=Table(error).fit("bias"))
    doubts({SPRING: "a bristle"})
    assert doubtful([*rungs[:2], gone]) is None


def test_what_needs_a_doubtful_effect_goes_first_and_then_the_doubtful_one(doubts, monkeypatch):
    """As friction behind a transmission whose tip is heavier than the whole body."""
    table = Table(error, needs=(("bias", "spring"),))
    rungs = ladder(table, "spring", "bias", "quadratic_drag")
    monkeypatch.setattr(rungs_module, "estimate", table.estimate)
    search = table.search()
    search.progress = lambda line: None
    doubts({SPRING: "no part of the body"})
    moved = remove_doubtful_rung(search, table.state(rungs), rungs)
    assert [r.added for r in moved.rungs[1:]] == [SPRING, DRAG]
    assert moved.set_aside[-1].reason == "it needs spring at device: no part of the body"
    moved = remove_doubtful_rung(search, moved, moved.rungs)
    assert [r.added for r in moved.rungs[1:]] == [DRAG]
    assert [one.candidate for one in moved.set_aside] == [BIAS, SPRING]
    assert moved.set_aside[-1].reason == "no part of the body"


@pytest.mark.parametrize(("by", "corrected"), [(0.9, True), (1.0, True), (100.0, False)])
def test_reading_errors_are_taken_off_unless_the_ladder_would_rise(monkeypatch, by, corrected):
    rungs = ladder(Table(error), "spring", "bias")
    table = Table(error)
    search = table.search()
    search.progress = lambda line: None
    without = worse(rungs[-1].fit, by)
    monkeypatch.setattr(module, "correct_fit", lambda search, fit, floor: without)
    last = with_last_corrected(search, table.state(rungs))
    assert last[:-1] == tuple(rungs[:-1]) and last[-1].added == BIAS
    assert last[-1].fit is (without if corrected else rungs[-1].fit)


@pytest.mark.parametrize("has_check", [True, False])
def test_a_fit_of_windows_has_the_errors_of_the_whole_records(monkeypatch, has_check):
    """Where blocks were held out instead of check records, their figures stay."""
    one = fit(0.3, at_command=0.2)
    one = Fit(
        one.model,
        (),
        0.25,
        0.3,
        (),
        *[one.check_residual] * 2,
        CommandError(one.check_residual, one.at_command.sighted, 0.2, 0.0),
        *[one.check_blocks] * 2,
        *[one.check_residual] * 3,
    )
    whole = {"fit": ["fit"], "check": ["check"] if has_check else []}
    monkeypatch.setattr(
        module, "force_error", lambda m, parts: {"fit": 0.5, "check": 0.6}[parts[0]]
    )
    command = SimpleNamespace(error=0.4, blind=0.1)
    monkeypatch.setattr(module, "refer_to_command", lambda model, parts: command)
    again = module._evaluate_on_all(one, SimpleNamespace(of=whole.__getitem__))
    figures = (again.fit_error, again.check_error, again.at_command.error, again.at_command.blind)
    assert figures == ((0.5, 0.6, 0.4, 0.1) if has_check else (0.5, 0.3, 0.2, 0.0))
    assert again.model is one.model
