"""The workbench of the page: effects are added one at a time, and taken back."""

import json

import numpy as np
import pytest
from design.closed_loop_campaign import keep_small

from teleopdesign import example, load_experiment
from teleopdesign.app import Workbench, charts, export, pages
from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import read_diagram
from teleopdesign.effects import EFFECTS

FEW = {name: EFFECTS[name] for name in ("coulomb", "viscous", "stribeck", "quadratic_drag")}


@pytest.fixture(scope="module")
def bench():
    return Workbench.of(load_experiment(example("rod")), known=FEW)


def test_a_candidate_is_added_with_the_error_that_it_was_listed_with(bench):
    best = bench.candidates[0]
    added = bench.add(*best.candidate.key)
    assert best.candidate.effect.name == "stribeck"
    assert added.state.fit.check_error == best.fit.check_error < 0.3 * bench.state.fit.check_error
    assert added.model.effects[-1] == ("stribeck", "device")
    assert not added.is_ranked and added.candidates == ()


def test_what_was_added_can_be_taken_back(bench):
    assert bench.add("stribeck", "device").take_back() == bench
    with pytest.raises(ModelError, match="nothing was added"):
        bench.take_back()


def test_a_candidate_that_is_not_there_is_named_with_the_nearest(bench):
    with pytest.raises(ModelError, match='no candidate "stribek at device".*stribeck at device'):
        bench.add("stribek", "device")


@pytest.fixture(scope="module")
def ranked(bench):
    """The bench with the missing effect, and its candidates ranked anew."""
    return bench.add("stribeck", "device").rank()


@pytest.mark.slow
def test_after_the_missing_effect_no_candidate_is_supported_and_the_diagnosis_names_it(
    bench, ranked
):
    assert ranked.is_ranked and ranked.state.supported == ()
    by_itself = bench.go_on()
    assert [r.added for r in by_itself.rungs] == [r.added for r in ranked.rungs]
    diagnosis = ranked.diagnosis()
    assert diagnosis.verdict == "effects_missing"
    assert [c.key for c in diagnosis.missing] == [("stribeck", "device")]


@pytest.mark.slow
def test_only_a_supported_candidate_is_preselected_and_the_end_has_a_verdict(bench, ranked):
    first = pages.supported_option(bench)
    assert first is not None and first.startswith("stribeck") and pages.verdict(bench) == ""
    assert ranked.candidates and pages.supported_option(ranked) is None
    assert "the model is adequate" in pages.verdict(ranked)


def test_the_chart_holds_the_samples_that_count_and_one_selection(bench):
    data = pages.residuals(bench)
    chart = charts.residual_chart(data, "device", "check")
    kind, text = chart._mime_()
    specification = json.loads(text)
    assert kind.startswith("application/vnd.vegalite")
    rows = specification["datasets"]["rows"]
    count = data["counts"].values & (data["use"].values == "check")
    assert 0.3 * charts.MOST < len(rows) <= charts.MOST
    share = np.sqrt(np.mean([r["residual"] ** 2 for r in rows]))
    every = np.sqrt(np.mean(data["residual"].values[count] ** 2))
    assert share == pytest.approx(every, rel=0.1)  # thinned samples of the same residual
    assert [p["name"] for p in specification["params"]] == ["span"]
    assert len(specification["params"][0]["views"]) == 3


def test_the_script_repeats_the_steps(bench):
    added = bench.add("stribeck", "device")
    text = export.script(added, "FOLDER")
    lines = [line for line in text.splitlines() if "with_effect" in line]
    assert lines == ["model = model.with_effect('stribeck', at='device')"]
    compile(text, "script.py", "exec")


@pytest.mark.slow  # a compensation is designed and simulated
def test_the_design_is_shown_from_its_claims_to_its_simulation_and_written_as_a_diagram(
    bench, tmp_path, monkeypatch
):
    keep_small(monkeypatch.setattr)
    added = bench.add("stribeck", "device")
    shown = pages.design_parts(added, "device")
    parts = {title: part for title, _, part in shown}
    captions = {title: caption for title, caption, _ in shown}
    titles = ["Before and after", "Numbers, reasons and claims", "Diagram", "Bode", "Impedance"]
    assert list(parts) == [*titles, "Simulation"]
    assert "proved" in parts["Numbers, reasons and claims"]
    assert parts["Diagram"].svg().startswith("<svg")
    assert all(f"`{name}` " in captions["Diagram"] for name in ("R_D", "R_A", "L", "R_MBC"))
    assert captions["Simulation"].endswith(" N.")
    position = parts["Simulation"].axes[0].lines[0].get_ydata()
    assert np.ptp(position) > 0
    assert "device_interface.toml" in export.write_all(added, tmp_path)
    file = tmp_path / "results" / added.experiment.folder.name / "device_interface.toml"
    assert [b.name for b in read_diagram(file).blocks] == ["Z_M", "H", "C"]


def test_a_moved_parameter_is_shown_beside_the_record_or_not_at_all(bench):
    name = "device.inertia"
    there, heavier = (pages.moved_residuals(bench, name, factor) for factor in (1.0, 1.5))
    left = [float(np.nanstd(data["residual"])) for data in (there, heavier)]
    assert left[1] > 1.05 * left[0]
    assert pages.moved_residuals(bench, name, -1.0) is None  # an inertia is not negative
