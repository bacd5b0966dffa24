"""What the page says is what the diagnosis holds."""

from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.blocks import Value
from teleopdesign.diagnose.answer import with_recording
from teleopdesign.diagnose.comparison import residual_data
from teleopdesign.diagnose.recording import DiagnosedRecording
from teleopdesign.diagnose.statements import Alternative, SetAside, Undetermined
from teleopdesign.show.report.candidate_table import candidate_rows
from teleopdesign.show.report.cannot_tell import cannot_tell
from teleopdesign.show.report.page import page_of, record_rows
from teleopdesign.show.report.parameter_table import parameter_rows
from teleopdesign.show.report.residuals import CELLS, body_views


def with_experiment(diagnosis, experiment):
    """The diagnosis with another recording, whatever its fingerprint."""
    return with_recording(diagnosis, DiagnosedRecording(stated=experiment))


def topics(diagnosis):
    return {f.topic for f in cannot_tell(diagnosis)}


def test_the_rungs_are_those_of_the_diagnosis(page, diagnosis):
    assert [r.check_error for r in page.ladder] == [r.check_error for r in diagnosis.rungs]
    assert page.left == pytest.approx(page.after / page.floor)


def test_the_rms_of_each_step_is_its_error_times_the_measured_force(page, diagnosis):
    (view,) = page.views
    shown = diagnosis.prepared.of("check")
    rows = sum(s.weight * len(s.keep) for s in shown)
    measured = np.sqrt(sum(s.measured for s in shown) / rows)
    for step, rung in zip(view.steps, diagnosis.rungs, strict=True):
        # the error counts every few rows of what is low-passed, the page all of them
        assert step.rms == pytest.approx(rung.check_error * measured, rel=0.01)


def test_a_map_holds_the_mean_residual_of_each_cell(page, diagnosis):
    (view,) = page.views
    data = residual_data(diagnosis.model, diagnosis.prepared)
    rows = (data["use"].values == "check") & data["counts"].values
    x, v, r = (data[n].values[rows] for n in ("position", "velocity", "residual"))
    assert view.steps[-1].mean.shape == CELLS[::-1]
    j, i = np.argwhere(np.isfinite(view.steps[-1].mean))[7]
    inside = (x >= view.position[i]) & (x < view.position[i + 1])
    inside &= (v >= view.velocity[j]) & (v < view.velocity[j + 1])
    assert view.steps[-1].mean[j, i] == pytest.approx(r[inside].mean())


def test_every_map_of_a_body_has_one_scale_and_noise_stays_pale(page):
    (view,) = page.views
    assert view.limit >= 4 * view.noise
    largest = np.nanquantile(np.abs(view.steps[0].mean), 0.98)
    assert largest <= view.limit <= 2 * max(largest, 4 * view.noise)


def test_the_trace_holds_the_extremes(page, diagnosis):
    data = residual_data(diagnosis.before.model, diagnosis.prepared)
    rows = (data["use"].values == "check") & data["counts"].values
    residual = data["residual"].values[rows]
    assert page.views[0].steps[0].high.max() == residual.max()
    assert page.views[0].steps[0].low.min() == residual.min()


def test_a_body_that_no_effect_changed_shows_one_step(diagnosis):
    same = replace(diagnosis.rungs[1], fitted=diagnosis.before.model)
    (view,) = body_views(replace(diagnosis, rungs=(diagnosis.rungs[0], same)), ("a", "b"))
    assert len(view.steps) == 1
    assert [s.name for s in view.over_carrier.series] == ["your model"]


def test_parameters_stand_beside_what_was_stated(diagnosis):
    rows = {r.name: r for r in parameter_rows(diagnosis)}
    stated = diagnosis.experiment.bodies["device"]
    assert rows["device.inertia"].stated == stated.inertia.value
    level = rows["device.coulomb.level"]
    assert level.stated == stated.effects["coulomb"]["level"].value
    assert level.before == diagnosis.before.model.parameters["device.coulomb.level"].value
    added = rows["device.stribeck.stribeck_velocity"]
    assert added.stated is None and added.before is None and added.added
    assert added.low == pytest.approx(added.after - 1.96 * added.stderr)


def with_value(diagnosis, name, value):
    return diagnosis.with_final_model(diagnosis.model.with_values({name: value}))


def test_a_fixed_parameter_has_no_interval(diagnosis):
    changed_diagnosis = with_value(diagnosis, "device.inertia", Value(0.2, fixed=True))
    row = next(r for r in parameter_rows(changed_diagnosis) if r.name == "device.inertia")
    assert row.fixed and row.stderr is None and row.low is None and row.high is None


def test_an_interval_ends_at_a_physical_bound(diagnosis):
    changed_diagnosis = with_value(diagnosis, "device.viscous.damping", Value(0.1, stderr=1.0))
    row = next(r for r in parameter_rows(changed_diagnosis) if r.name == "device.viscous.damping")
    assert row.low == 0.0 and row.high == pytest.approx(2.06)


def test_a_parameter_at_its_bound_or_left_open_is_reported_as_such(diagnosis):
    name = "device.viscous.damping"
    bound = replace(with_value(diagnosis, name, Value(0.0, stderr=1.0)), at_bound=(name,))
    assert "a parameter at its bound" in topics(bound)
    assert next(r for r in parameter_rows(bound) if r.name == name).at_bound
    unsure = cannot_tell(with_value(diagnosis, name, Value(0.1, stderr=1.0)))
    finding = next(f for f in unsure if f.topic == "a parameter left open")
    assert "device.viscous.damping is not determined: 0.1 ± 1.0 N·s/m" in finding.sentence


def test_values_that_are_not_determined_and_effects_set_aside_stand_on_the_page(diagnosis):
    added = diagnosis.rungs[1].added
    other = diagnosis.candidates[-1].candidate
    both = replace(
        diagnosis,
        undetermined=(Undetermined(added, "the level at rest is not told"),),
        set_aside=(SetAside(other, 0.034, "it is not told from absence"),),
    )
    findings = {f.topic: f for f in cannot_tell(both)}
    assert (
        findings["values that are not determined"].sentence
        == f"{added}: the level at rest is not told."
    )
    aside = findings["effects set aside"]
    assert aside.sentence == (
        f"{other} lowered the error to 3.40\u202f% and was taken out again: it is not told from "
        "absence."
    )
    assert aside.numbers == {"check_error": 0.034} and aside.where == other.at


def test_estimates_that_move_together_are_named_as_a_pair(diagnosis):
    fit = diagnosis.last_fit
    columns = fit.jacobian.copy()
    # the second column is the first but for a tenth: a correlation of 0.995
    rest = np.roll(columns[:, 0], 101) - columns[:, 0] * float(
        np.roll(columns[:, 0], 101) @ columns[:, 0] / (columns[:, 0] @ columns[:, 0])
    )
    columns[:, 1] = columns[:, 0] + 0.1 * rest
    copied = replace(diagnosis)
    vars(copied)["last_fit"] = replace(fit, jacobian=columns)
    findings = cannot_tell(copied)
    (pair,) = [f for f in findings if f.topic == "parameters known only together"]
    assert fit.free[0] in pair.sentence and fit.free[1] in pair.sentence
    assert abs(pair.numbers["correlation"]) > 0.95


def test_look_alikes_come_with_the_reason(diagnosis):
    other = diagnosis.candidates[-1].candidate
    for one in (Alternative(other, 0.011, apart=0.5, likeness=0.99), Alternative(other)):
        alike = replace(diagnosis.rungs[1], alternatives=(one,))
        finding = cannot_tell(replace(diagnosis, rungs=(diagnosis.rungs[0], alike)))[0]
        assert finding.concern == "warning" and str(other) in finding.sentence
        if one.apart == one.apart:  # an older answer does not say it
            assert finding.numbers["correlation"] == 0.99
            assert finding.numbers["standard_deviations_apart"] == 0.5


def test_an_effect_that_was_no_candidate_says_what_it_needs(diagnosis):
    first = tuple(replace(c, steps=c.steps[:1]) for c in diagnosis.candidates)
    only = replace(diagnosis, rungs=diagnosis.rungs[:1], candidates=first)
    finding = next(f for f in cannot_tell(only) if f.topic == "effects that were no candidates")
    assert "friction_memory at device (needs stribeck beside it)" in finding.sentence


def test_without_a_check_record_the_page_says_so(diagnosis):
    experiment = diagnosis.experiment
    fit_only = replace(experiment, records=experiment.fit_records)
    page = page_of(with_experiment(diagnosis, fit_only))
    assert "no check record" in {f.topic for f in page.cannot_tell}
    assert "held out of the fit" in page.verdict
    assert page.shown == "fit records"


def test_candidates_stand_in_the_order_of_what_became_of_them(diagnosis):
    rows = candidate_rows(diagnosis)
    assert rows[0].effect == "stribeck" and rows[0].steps[0].outcome == "added"
    assert rows[0].steps[1] is None, "it was there already"
    assert {r.effect for r in rows} == {c.candidate.effect.name for c in diagnosis.candidates}
    assert next(r for r in rows if r.effect == "friction_memory").steps[0] is None


def test_records_come_with_the_digest_of_their_files(page, diagnosis):
    import hashlib

    folder = diagnosis.experiment.folder
    for row in page.records:
        assert row.digest == hashlib.sha256((folder / row.file).read_bytes()).hexdigest()


def test_a_record_file_that_is_gone_has_no_digest(diagnosis, tmp_path):
    gone = with_experiment(diagnosis, replace(diagnosis.experiment, folder=tmp_path))
    assert {r.digest for r in page_of(gone).records} == {""}


def test_a_record_that_is_a_part_of_a_log_or_a_bag_comes_with_its_digest(tmp_path, diagnosis):
    import hashlib

    (tmp_path / "log.csv").write_bytes(b"whole")
    (tmp_path / "bag").mkdir()
    for name, content in (("b.db3", b"ole"), ("a.yaml", b"wh")):
        (tmp_path / "bag" / name).write_bytes(content)
    record = diagnosis.experiment.records[0]
    files = ("log.csv", "log.csv 0-14.4 s", "log.csv 1e-05-2.5e+03 s", "bag", "bag 0-2 s")
    whole = replace(
        diagnosis.experiment,
        folder=tmp_path,
        records=tuple(replace(record, file=file) for file in files),
    )
    digest = hashlib.sha256(b"whole").hexdigest()
    assert [row.digest for row in record_rows(whole)] == [digest] * len(files)


def test_what_the_file_states_is_shown_also_with_few_candidates(diagnosis):
    few = {"stribeck": diagnosis.model.known["stribeck"]}
    rungs = tuple(replace(rung, fitted=replace(rung.model, known=few)) for rung in diagnosis.rungs)
    rows = parameter_rows(replace(diagnosis, rungs=rungs))
    assert [r.stated for r in rows] == [r.stated for r in parameter_rows(diagnosis)]
    assert any(r.stated is not None for r in rows)


def test_a_record_too_short_for_any_cell_of_the_map_has_a_page(diagnosis):
    few = tuple(replace(s, keep=s.keep[:2]) for s in diagnosis.prepared.stretches)
    short = with_experiment(diagnosis, diagnosis.experiment)
    records = replace(diagnosis.prepared, stretches=few)
    vars(short.recording)["parts"] = replace(diagnosis.recording.parts, parts={"": records})
    views = body_views(short, tuple(str(i) for i in range(len(diagnosis.rungs))))
    for step in views[0].steps:
        assert np.isnan(step.mean).all(), "a mean of fewer than three samples"
    assert views[0].limit >= 4 * views[0].noise
