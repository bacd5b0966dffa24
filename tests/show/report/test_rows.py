"""Rows of a page's tables: intervals, outcomes, correlations, shares, against closed forms."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.blocks import Value
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.fit import Fit
from teleopdesign.diagnose.statements import Alternative, CandidateResult, StepResult
from teleopdesign.show.report import (
    cannot_tell,
    parameter_table,
    provenance,
    write,
)
from teleopdesign.show.report.candidate_table import candidate_rows, candidate_steps, ladder_lines
from teleopdesign.show.report.parameter_table import added_effects, parameter_rows


def test_a_rung_says_its_errors_and_how_many_noise_floors_they_are(diagnosis):
    rows = ladder_lines(diagnosis)
    for row, rung in zip(rows, diagnosis.rungs, strict=True):
        assert (row.fit_error, row.check_error) == (rung.fit_error, rung.check_error)
        assert row.floors * diagnosis.floor.value == pytest.approx(rung.check_error)
    assert [r.brief for r in rows] == ["your model", "stribeck"]
    free = ladder_lines(replace(diagnosis, floor=replace(diagnosis.floor, value=0.0)))
    assert all(r.floors == math.inf for r in free)


def test_each_step_of_the_candidates_has_a_heading_and_the_error_before(diagnosis):
    steps = candidate_steps(diagnosis)
    assert [s.heading for s in steps] == ["on your model", "with stribeck"]
    assert [s.check_error for s in steps] == [r.check_error for r in diagnosis.rungs]


def test_the_order_of_candidates_is_added_then_probable_then_small_error(diagnosis):
    def best(row):
        return min(s.check_error for s in row.steps if s is not None)

    first, *rest = candidate_rows(diagnosis)
    assert first.effect == "stribeck"
    for one, other in zip(rest, rest[1:], strict=False):
        alike = round(one.probability, 2) == round(other.probability, 2)
        assert one.probability > other.probability or alike and best(one) <= best(other)


@pytest.mark.parametrize(
    ("effect", "refused", "message"),
    [
        ("stribeck", "", "added"),
        ("spring", "weak", "weak"),
        ("spring", "it stands for a gap", "implausible"),
        ("spring", None, ""),
        ("quadratic_drag", None, "as good"),
    ],
)
def test_where_the_steps_are_not_known_a_candidate_has_one_and_what_became_of_it(
    diagnosis, effect, refused, message
):
    there = {c.candidate.effect.name: c.candidate for c in diagnosis.candidates}
    row = CandidateResult(there[effect], 0.25, 0.04, {}, refused=refused)
    alike = (Alternative(there["quadratic_drag"]),)
    rungs = (diagnosis.rungs[0], replace(diagnosis.rungs[1], alternatives=alike))
    older = replace(diagnosis, rungs=rungs, candidates=(row,))
    (entry,) = candidate_rows(older)
    (step,) = entry.steps
    assert (entry.effect, entry.at, entry.probability) == (effect, "device", 0.25)
    assert (step.check_error, step.outcome) == (0.04, message) and math.isnan(step.score)
    (heading,) = candidate_steps(older)
    assert heading.check_error == diagnosis.before.check_error


# parameters


@pytest.mark.parametrize(
    ("value", "stderr", "lower", "upper", "ends"),
    [
        (2.0, 0.5, -math.inf, math.inf, (1.02, 2.98)),
        (2.0, 0.5, 1.5, math.inf, (1.5, 2.98)),
        (2.0, 0.5, 0.0, 2.5, (1.02, 2.5)),
        (2.0, math.nan, 0.0, 9.0, (None, None)),
        (2.0, math.inf, 0.0, 9.0, (None, None)),
    ],
)
def test_an_interval_has_975_of_a_normal_law_on_each_side_within_the_bounds(
    value, stderr, lower, upper, ends
):
    interval = parameter_table._interval(Value(value, stderr=stderr), lower, upper)
    assert interval == ((None, None) if ends[0] is None else pytest.approx(ends, rel=1e-3))
    fixed = Value(value, fixed=True, stderr=stderr)
    assert parameter_table._interval(fixed, lower, upper) == (None, None)


def test_a_row_says_what_the_models_before_and_after_hold(diagnosis):
    rows = parameter_rows(diagnosis)
    assert {r.name for r in rows} == set(diagnosis.model.parameters)
    for row in rows:
        after, before = diagnosis.model.parameters[row.name], diagnosis.before.model.parameters
        assert (row.after, row.fixed, row.at) == (after.value, after.fixed, "device")
        assert row.name == ".".join(filter(None, ("device", row.effect, row.parameter)))
        assert row.added == (row.effect == "stribeck") == (row.name not in before)
        if row.name in before:
            assert row.before == before[row.name].value
            assert row.before_stderr == before[row.name].stderr
        assert row.stderr == after.stderr and not row.at_bound
        assert row.unit == diagnosis.model.unit(row.name) and not row.gave_way_to
    (added,) = added_effects(diagnosis, rows)
    assert added.parameters == tuple(r for r in rows if r.effect == "stribeck")
    assert (added.effect, added.at, added.alike) == ("stribeck", "device", ())
    assert added.source and added.title and added.law == added.law.strip()


# what cannot be told


def fit_with(diagnosis, columns, names, correlated=None) -> Fit:
    return replace(diagnosis.last_fit, jacobian=np.array(columns).T, free=names)


@given(correlation=st.sampled_from([0.9, 0.94, 0.96, 0.999, -0.96, -0.94]), size=st.floats(0.1, 50))
def test_estimates_are_known_only_together_from_a_correlation_of_095(diagnosis, correlation, size):
    # of two unit columns with cosine c the estimates have the correlation -c
    one, other = (
        np.array([1.0, 0.0, 0.0]),
        np.array([-correlation, math.sqrt(1 - correlation**2), 0.0]),
    )
    # a parameter that no row sees is no part of it
    fit = fit_with(diagnosis, [one, np.zeros(3), size * other], ("a", "unseen", "b"))
    findings = cannot_tell._find_correlated(fit)
    if abs(correlation) < 0.95:
        assert not findings
    else:
        (pair,) = findings
        assert pair.numbers["correlation"] == pytest.approx(correlation, rel=1e-6)
        assert pair.sentence.startswith("a and b are known only together")


def test_the_closest_pairs_are_listed_first_and_six_at_most(diagnosis):
    # five columns that are nearly one: ten pairs
    rng = np.random.default_rng(0)
    base = rng.normal(size=40)
    base /= np.linalg.norm(base)
    wide = [base + rng.normal(size=40) * 1e-4 * (k + 1) for k in range(2)]
    apart = [rng.normal(size=40) for _ in range(3)]
    near = [a + rng.normal(size=40) * 0.02 for a in apart for _ in range(3)]
    fit = fit_with(diagnosis, [*wide, *near], tuple("abcdefghijk"))
    correlations = [f.numbers["correlation"] for f in cannot_tell._find_correlated(fit)]
    assert len(correlations) <= cannot_tell.PAIRS
    assert [abs(r) for r in correlations] == sorted((abs(r) for r in correlations), reverse=True)
    assert "a and b" in cannot_tell._find_correlated(fit)[0].sentence


@pytest.mark.parametrize(
    ("value", "stderr", "is_open"),
    [(1.0, 0.99, False), (1.0, 1.0, True), (0.5, math.inf, True)],
)
def test_a_parameter_is_left_open_from_an_error_as_large_as_its_value(
    diagnosis, value, stderr, is_open
):
    name = "device.viscous.damping"
    model = diagnosis.model.with_values({name: Value(value, stderr=stderr)})
    there = cannot_tell._open_parameters(diagnosis.with_final_model(model))
    findings = [f for f in there if name in f.sentence]
    assert [f.numbers["value"] for f in findings] == ([value] if is_open else [])
    if is_open:
        distinguished = "cannot be distinguished" in findings[0].sentence
        assert distinguished == math.isinf(stderr) and findings[0].numbers["stderr"] == stderr


@pytest.mark.parametrize(
    ("at_bound", "like", "sentence"), [(False, False, 0), (True, False, 1), (False, True, 1)]
)
def test_a_shift_of_the_log_is_reported_where_it_is_at_its_bound_or_like_a_delay(
    diagnosis, at_bound, like, sentence
):
    class Shift(SimpleNamespace):
        def __str__(self):
            return "the log is late"

    shift = Shift(at_bound=at_bound, is_like_a_delay=like, late=2e-3, stderr=1e-4, row=1e-3)
    finding = cannot_tell._clock(replace(diagnosis, record_shift={"device": shift}))
    assert len(finding) == sentence
    for one in finding:
        assert one.sentence == "the log is late."
        assert one.numbers == {"late": 2e-3, "stderr": 1e-4, "row": 1e-3}


def with_last_steps(diagnosis, last):
    """Name of a candidate -> its result on the last step; all others were not fitted there."""
    rows = tuple(
        replace(c, steps=(None, last.get(c.candidate.effect.name))) for c in diagnosis.candidates
    )
    return replace(diagnosis, candidates=rows)


def test_effects_that_may_be_there_unseen_are_those_not_determined(diagnosis):
    step = StepResult(0.04, 1.0, "")
    last = {"spring": replace(step, determined=False), "bias": step}
    (finding,) = cannot_tell._open_candidates(with_last_steps(diagnosis, last))
    assert "spring at device" in finding.sentence and "bias" not in finding.sentence
    assert cannot_tell._open_candidates(with_last_steps(diagnosis, {"bias": step})) == []


def test_a_candidate_of_the_last_step_or_an_effect_of_the_model_is_not_called_excluded(diagnosis):
    one = with_last_steps(diagnosis, {"spring": StepResult(0.04, 1.0, "")})
    (finding,) = cannot_tell._excluded_effects(one)
    there = {"coulomb", "viscous", "stribeck", "spring"}
    for name in diagnosis.model.known:
        assert (f"{name} at device" in finding.sentence) == (name not in there)
    every = [Candidate(e, "device") for e in diagnosis.model.known.values()]
    older = tuple(CandidateResult(c, 0.0, 0.04, {}) for c in every)
    assert cannot_tell._excluded_effects(replace(diagnosis, candidates=older)) == []


def test_what_a_search_left_out_is_one_sentence(diagnosis):
    findings = cannot_tell._findings_on_exclusions(
        replace(diagnosis, left_out=("few effects", "one rung"))
    )
    assert [f.sentence for f in findings] == ["Few effects; one rung."]


# records and channels


def test_a_record_is_described_by_its_samples_duration_and_rate(diagnosis):
    experiment = diagnosis.experiment
    for row, record in zip(provenance.record_rows(experiment), experiment.records, strict=True):
        time = record.time
        assert (row.file, row.use, row.samples) == (record.file, record.use, len(time))
        assert row.rate == pytest.approx((len(time) - 1) / (time[-1] - time[0]), rel=1e-3)
        assert row.samples / row.rate == pytest.approx(row.duration, rel=0.01)
        assert row.segments == len(record.segments)


def test_a_channel_is_described_in_units_of_its_quantity_along_its_axis(diagnosis):
    rows = {r.name: r for r in provenance.channel_rows(diagnosis.experiment)}
    assert set(rows) == set(diagnosis.experiment.channels)
    revolute = diagnosis.experiment.axis("device") == "revolute"
    for name, row in rows.items():
        channel = diagnosis.experiment.channels[name]
        assert (row.column, row.resolution) == (channel.column, channel.resolution)
        expected = {"position": "rad" if revolute else "m", "time": ""}
        kind = "time" if channel.body is None else channel.quantity
        assert row.si_unit == expected.get(kind, "N*m" if revolute else "N")


# filters of the page


@given(whole=st.floats(-10, 100), part=st.floats(-100, 200))
def test_a_share_is_a_percentage_of_the_whole_within_0_and_100(whole, part):
    share = float(write._share(whole, part))
    expected = min(max(100 * part / whole, 0), 100) if whole > 1e-9 else None
    assert 0 <= share <= 100
    if expected is not None:
        assert share == pytest.approx(expected, abs=0.0501)
    if whole <= 0:
        assert share == 0


def test_names_stand_out_as_whole_words_and_break_at_their_parts():
    sentence = "lacks <coulomb>, coulombs and viscous"
    assert write._emphasise_names(sentence, ["coulomb", "viscous"]) == (
        "lacks &lt;<b>coulomb</b>&gt;, coulombs and <b>viscous</b>"
    )
    assert write._soft("a_b.c/<d>e") == "a_<wbr>b.<wbr>c/<wbr>&lt;d&gt;e"


def test_every_finding_with_a_graph_and_each_body_have_a_figure(page, figures):
    from teleopdesign.base.finding import Finding, Graph, Series

    x = np.arange(4.0)
    graph = Graph("x", "y", (Series("a", x, x),))
    rows = (Finding("topic", "note", "none"), Finding("topic", "note", "drawn", graph=graph))
    full = replace(page, views=(), cannot_tell=rows[:1], soundness=rows, unexplained=rows[1:])
    drawings = write.figures_of(replace(full, next_steps=(*rows, rows[1])))
    keys = {("soundness", 1), ("unexplained", 0), ("next", 1), ("next", 2)}
    assert set(drawings.findings) == keys and drawings.scales == drawings.steps == ()
    assert all('alt="topic: drawn"' in drawn for drawn in drawings.findings.values())
    assert len(figures.scales) == len(figures.excerpts) == len(figures.over_velocity) == 1
    assert [len(s) for s in figures.steps] == [len(v.steps) for v in page.views]
    assert "mean residual over velocity, before and after." in figures.over_velocity[0]
    assert "measured and modelled force, before and after." in figures.excerpts[0]
