"""The answer as files and as text."""

import csv
import gzip
import json
from dataclasses import replace

import numpy as np
import pytest
from diagnose.contract import violations
from diagnose.simulated_cases import FEW

from teleopdesign import EFFECTS, Model, compare, find_missing
from teleopdesign.diagnose.answer import answer, write_answer
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.predictions import write_predictions
from teleopdesign.diagnose.probability import shares
from teleopdesign.diagnose.ranking import REFUSALS
from teleopdesign.diagnose.statements import Alternative, NotAccepted
from teleopdesign.show.diagnose.text import ladder_text
from teleopdesign.show.diagnose.verdict import sentence

EVERY_KEY = {
    "verdict", "missing", "ladder", "noise_floor", "candidates", "indistinguishable",
    "model_parameters",
}  # fmt: skip


@pytest.fixture(scope="module")
def written(diagnosis, tmp_path_factory):
    file = tmp_path_factory.mktemp("answer") / "answer.json"
    write_answer(diagnosis, file)
    return json.loads(file.read_text(), parse_constant=lambda name: pytest.fail(name))


def test_the_answer_file_keeps_the_format(written):
    assert set(written) >= EVERY_KEY
    assert violations(written) == []


def test_what_is_less_likely_than_not_is_not_named(diagnosis):
    unnamed = tuple(replace(r, named=False) for r in diagnosis.rungs)
    unlikely = replace(diagnosis, verdict="undecided", rungs=unnamed)
    assert unlikely.unlikely and not diagnosis.unlikely
    assert answer(unlikely)["missing"] == []
    # the leading candidate is still shown
    assert answer(unlikely)["candidates"][0]["effect"] == "stribeck"
    assert "less likely than not" in ladder_text(unlikely)


def test_one_of_two_look_alikes_is_called_missing_beside_an_unlikely_effect(diagnosis):
    """A weak second step does not take away what is said of the first one."""
    first = diagnosis.rungs[1]
    beside = Candidate(EFFECTS["bias"], "device")
    alike = replace(first, named=False, alternatives=(Alternative(beside),))
    weak = replace(first, added=Candidate(EFFECTS["spring"], "device"), named=False)
    rows = (diagnosis.rungs[0], alike, weak)
    verdict = sentence(replace(diagnosis, verdict="undecided", rungs=rows))
    assert "stribeck at device or bias at device is missing" in verdict
    assert "spring at device: less likely than not" in verdict


def test_a_verdict_says_which_refused_effect_leaves_less(diagnosis):
    blind = Candidate(EFFECTS["actuator_dead_zone"], "device")
    less = 0.5 * diagnosis.before.check_error
    refused = NotAccepted("refused", blind, less, less, REFUSALS["blind"])
    alone = replace(diagnosis, rungs=diagnosis.rungs[:1], not_accepted=(refused,))
    alone = replace(alone, verdict="undecided")
    assert "actuator_dead_zone" in sentence(alone)
    hides = replace(alone, not_accepted=(replace(refused, check_error_at_command=1.0),))
    assert "actuator_dead_zone" not in sentence(hides)


def test_the_answer_states_the_result_of_the_diagnosis(written, diagnosis):
    assert written["verdict"] == "effects_missing"
    assert written["missing"][0] == {"effect": "stribeck", "at": "device"}
    assert written["check"] == "records"
    assert written["bandwidth"] == {"value": diagnosis.bandwidth, "unit": "Hz", "source": "stated"}
    best = written["candidates"][0]
    assert best["effect"] == "stribeck" and best["probability"] > 0.8
    assert set(best["parameters"]) == {"extra_static_level", "stribeck_velocity"}
    assert best["parameters"]["extra_static_level"]["unit"] == "N*m"
    assert set(written["model_parameters"]) == set(diagnosis.before.model.parameters)


def test_every_effect_of_the_search_is_a_candidate(written, end):
    keys = {r.candidate.key for g in (end.rungs[1].ranking, end.last) for r in g.ranked}
    assert {(c["effect"], c["at"]) for c in written["candidates"]} == keys


def test_shares_of_a_ranking_sum_to_one(end):
    portions = shares(end.rungs[1].ranking, end.rungs[1])
    assert sum(portions.values()) == pytest.approx(1.0)
    assert max(portions, key=portions.get) == ("stribeck", "device")


def test_predictions_hold_every_sample_and_add_up(diagnosis, experiment, tmp_path):
    file = tmp_path / "predictions.csv"
    write_predictions(diagnosis, file)
    with file.open() as opened:
        head = next(csv.reader(opened))
        rows = list(csv.DictReader(opened, head))
    assert head == [
        "record", "t", "device.measured", "device.model_before", "device.model_after",
        "device.residual_before", "device.residual_after",
    ]  # fmt: skip
    assert len(rows) == sum(len(r.time) for r in experiment.records)
    assert {r["record"] for r in rows} == {"fit.csv.gz", "check.csv.gz"}
    column = {n: np.array([float(r[n]) for r in rows]) for n in head[1:]}
    for which in ("before", "after"):
        total = column[f"device.model_{which}"] + column[f"device.residual_{which}"]
        # seven digits are written
        np.testing.assert_allclose(total, column["device.measured"], atol=3e-6 * total.max())
    record = experiment.records[0]
    np.testing.assert_allclose(column["t"][: len(record.time)], record.time, atol=1e-9)
    zipped = tmp_path / "predictions.csv.gz"
    write_predictions(diagnosis, zipped)
    with gzip.open(zipped, "rt") as a, file.open() as b:
        assert a.read() == b.read().replace("\r\n", "\n")


@pytest.mark.slow
def test_a_diagnosis_without_check_record_says_so(experiment):
    only = replace(experiment, records=experiment.fit_records)
    few = {n: FEW[n] for n in ("coulomb", "viscous", "stribeck")}
    diagnosis = answer(find_missing(only, Model.from_experiment(only, few)))
    assert diagnosis["check"] == "blocks of fit"
    assert violations(diagnosis) == []
    assert diagnosis["missing"] == [{"effect": "stribeck", "at": "device"}]


def test_a_comparison_holds_the_figures_and_the_labelled_forces(experiment, diagnosis):
    comparison = compare(diagnosis.before.model, experiment)
    assert comparison.fit_error == pytest.approx(diagnosis.before.fit_error)
    assert comparison.check_error == pytest.approx(diagnosis.before.check_error)
    assert comparison.data.sizes["sample"] == sum(len(r.time) for r in experiment.records)
    np.testing.assert_allclose(
        comparison.data["model"] + comparison.data["residual"],
        comparison.data["measured"],
        atol=1e-12,
    )
    assert comparison.data["measured"].attrs["units"] == "N*m"
    assert "check error" in repr(comparison) and "%" in repr(comparison)
