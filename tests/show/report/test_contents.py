"""What the page says is what the diagnosis holds."""

from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.blocks import Value
from teleopdesign.diagnose.answer import with_recording
from teleopdesign.diagnose.by_simulation import simulated_if_possible
from teleopdesign.diagnose.recording import DiagnosedRecording
from teleopdesign.show.report.cannot_tell import cannot_tell
from teleopdesign.show.report.motion import simulated_motions
from teleopdesign.show.report.residuals import body_views
from teleopdesign.show.report.tables import parameter_rows


def with_experiment(diagnosis, experiment):
    """The diagnosis with another recording, whatever its fingerprint."""
    return with_recording(diagnosis, DiagnosedRecording(stated=experiment))


def topics(diagnosis):
    return {f.topic for f in cannot_tell(diagnosis)}


def test_the_rms_of_each_step_is_its_error_times_the_measured_force(page, diagnosis):
    (view,) = page["views"]
    shown = diagnosis.prepared.of("check")
    rows = sum(s.weight * len(s.keep) for s in shown)
    measured = np.sqrt(sum(s.measured for s in shown) / rows)
    for step, rung in zip(view.steps, diagnosis.rungs, strict=True):
        # the error counts every few rows of what is low-passed, the page all of them
        assert step.rms == pytest.approx(rung.check_error * measured, rel=0.01)


def test_the_right_model_has_the_recorded_impedance_along_the_motion(page):
    (view,) = page["impedances"]
    known = np.isfinite(view.recorded.magnitude[0]) & (view.recorded.frequency < 30.0)
    ratio = view.along.values()[known] / view.recorded.values()[known]
    assert known.sum() > 15 and np.abs(np.log(ratio)).max() < 0.05
    assert view.derived.band is not None and view.left_out == ()


def test_the_simulated_motion_lies_over_the_measured_one_with_its_fit(diagnosis):
    comparison = simulated_if_possible(diagnosis)
    (motion,) = simulated_motions(comparison, ["device"])
    assert simulated_motions(comparison, ["master"]) == simulated_motions(None, ["device"]) == ()
    assert motion.fit == comparison.error(np.inf).fit and motion.use == "check"
    measured, simulated, restarted = motion.graph.series
    assert (measured.kind, simulated.kind) == ("course", "model")
    assert restarted.name.startswith("restarted each 1 s")
    low, high = np.nanmin(measured.y), np.nanmax(measured.y)
    assert np.nanmax(simulated.y) <= high + 0.5 * (high - low)


def test_parameters_stand_beside_what_was_stated(diagnosis):
    rows = {r["name"]: r for r in parameter_rows(diagnosis)}
    stated = diagnosis.experiment.bodies["device"]
    assert rows["device.inertia"]["stated"] == stated.inertia.value
    level = rows["device.coulomb.level"]
    assert level["stated"] == stated.effects["coulomb"]["level"].value
    assert level["before"] == diagnosis.before.model.parameters["device.coulomb.level"].value
    added = rows["device.stribeck.stribeck_velocity"]
    assert added["stated"] is None and added["before"] is None and added["added"]
    assert added["low"] == pytest.approx(added["after"] - 1.96 * added["stderr"])


def with_value(diagnosis, name, value):
    return diagnosis.with_final_model(diagnosis.model.with_values({name: value}))


def test_a_parameter_at_its_bound_or_left_open_is_reported_as_such(diagnosis):
    name = "device.viscous.damping"
    bound = replace(with_value(diagnosis, name, Value(0.0, stderr=1.0)), at_bound=(name,))
    assert "a parameter at its bound" in topics(bound)
    assert next(r for r in parameter_rows(bound) if r["name"] == name)["at_bound"]
    unsure = cannot_tell(with_value(diagnosis, name, Value(0.1, stderr=1.0)))
    finding = next(f for f in unsure if f.topic == "a parameter left open")
    assert "device.viscous.damping is not determined: 0.1 ± 1.0 N·s/m" in finding.sentence


def test_records_come_with_the_digest_of_their_files(page, diagnosis):
    import hashlib

    folder = diagnosis.experiment.folder
    for row in page["records"]:
        assert row["digest"] == hashlib.sha256((folder / row["file"]).read_bytes()).hexdigest()


def test_a_record_too_short_for_any_cell_of_the_map_has_a_page(diagnosis):
    few = tuple(replace(s, keep=s.keep[:2]) for s in diagnosis.prepared.stretches)
    short = with_experiment(diagnosis, diagnosis.experiment)
    records = replace(diagnosis.prepared, stretches=few)
    vars(short.recording)["parts"] = replace(diagnosis.recording.parts, parts={"": records})
    views = body_views(short, tuple(str(i) for i in range(len(diagnosis.rungs))))
    for step in views[0].steps:
        assert np.isnan(step.mean).all(), "a mean of fewer than three samples"
    assert views[0].limit >= 4 * views[0].noise
