"""An answer read back: the same model, the same diagnosis, and one line for whatever else it is."""

import copy
import json
from dataclasses import replace

import pytest
from diagnose.simulated_cases import FEW
from measurement.rod_example import PAIR, rows

import teleopdesign as td
from teleopdesign import EFFECTS, ExperimentError, Model, Value
from teleopdesign.base.files import write_json
from teleopdesign.cli import main
from teleopdesign.diagnose.answer import answer, load_answer, write_answer
from teleopdesign.diagnose.model_data import model_data, model_from
from teleopdesign.diagnose.predictions import write_predictions
from teleopdesign.effects import catalogue
from teleopdesign.show.report import write_report

#: what came later than the rest of the format
LATER = ("experiment", "models", "floor", "open")


@pytest.fixture(scope="module")
def path(diagnosis, tmp_path_factory):
    file = tmp_path_factory.mktemp("answer") / "answer.json"
    write_answer(diagnosis, file)
    return file


@pytest.fixture(scope="module")
def content(path):
    return json.loads(path.read_text())


@pytest.fixture
def changed(content, tmp_path):
    """Writes the answer with some keys changed (None: taken away); returns its path."""

    def write(**values):
        new = copy.deepcopy(content) | values
        file = tmp_path / "changed.json"
        file.write_text(json.dumps({k: v for k, v in new.items() if v is not ...}))
        return file

    return write


def numbers(model):
    return {n: (v.value, v.fixed, repr(v.stderr)) for n, v in model.parameters.items()}


def assert_same(one, other):
    assert one.effects == other.effects
    assert {n: b.axis for n, b in one.bodies.items()} == {
        n: b.axis for n, b in other.bodies.items()
    }
    assert numbers(one) == numbers(other)


def test_what_is_read_back_is_what_was_written(path, diagnosis, experiment):
    for read in (load_answer(path, FEW), load_answer(path, FEW, experiment=experiment)):
        assert read == diagnosis and repr(read) == repr(diagnosis)
        assert read._repr_html_() == diagnosis._repr_html_()
        assert_same(read.model, diagnosis.model)
    assert load_answer(path, FEW).experiment == experiment, "by the folder that the answer names"


@pytest.mark.slow
def test_the_report_and_the_predictions_are_the_same_from_memory_and_from_the_answer(
    path, diagnosis, tmp_path
):
    for name, one in (("memory", diagnosis), ("answer", load_answer(path, FEW))):
        write_report(one, tmp_path / f"{name}.html")
        write_predictions(one, tmp_path / f"{name}.csv")
    for ending in ("html", "csv"):
        files = [(tmp_path / f"{name}.{ending}").read_bytes() for name in ("memory", "answer")]
        assert files[0] == files[1]


def test_a_diagnosis_needs_no_recording_for_what_it_says(path, diagnosis, tmp_path):
    content = json.loads(path.read_text())
    del content["experiment"]["folder"]
    alone = tmp_path / "alone.json"
    alone.write_text(json.dumps(content))
    read = load_answer(alone, FEW)
    assert repr(read) == repr(diagnosis) and answer(read) == answer(diagnosis)
    with pytest.raises(ExperimentError, match="does not say where its records are"):
        read.plot()


def test_an_older_answer_is_read_with_what_its_experiment_says(changed, diagnosis, experiment):
    file = changed(**dict.fromkeys(LATER, ...))
    older = load_answer(file, FEW, experiment=experiment)
    assert_same(older.model, diagnosis.model)
    assert (older.verdict, older.left) == (diagnosis.verdict, diagnosis.left)
    assert str(older).splitlines()[-1] == str(diagnosis).splitlines()[-1]
    alone = load_answer(file, FEW).model
    assert alone.bodies["device"].axis == "revolute", "the inertia is in kg*m^2"
    values = {n: v.value for n, v in diagnosis.model.parameters.items()}
    assert {n: v.value for n, v in alone.parameters.items()} == values
    with pytest.raises(ExperimentError, match='no key "models": the answer of an earlier version'):
        older.before.model  # noqa: B018
    with pytest.raises(ExperimentError, match='no key "open": the answer of an earlier version'):
        older.questions  # noqa: B018


@pytest.mark.parametrize("old", [False, True])
def test_the_answer_to_another_experiment_is_refused(old, changed):
    file = changed(**dict.fromkeys(LATER, ...)) if old else changed()
    rod = td.load_experiment(td.example("rod"))
    with pytest.raises(ExperimentError, match="is not an answer to rod but to another") as why:
        load_answer(file, experiment=rod)
    assert str(why.value).startswith(f"{file}: ") and "\n" not in str(why.value)


def test_records_that_read_differently_now_are_noticed(path, experiment):
    record = experiment.records[0]
    signals = {n: v.copy() for n, v in record.signals.items()}
    signals["device.position"][100] += 1e-12
    other = replace(experiment, records=(replace(record, signals=signals), *experiment.records[1:]))
    with pytest.raises(ExperimentError, match="records of the same length, but they read differ"):
        load_answer(path, experiment=other)


def test_a_record_whose_file_was_renamed_is_the_same_record(path, experiment):
    first, *others = experiment.records
    renamed = replace(experiment, records=(replace(first, file="renamed.csv"), *others))
    assert load_answer(path, experiment=renamed).model is not None


def test_an_effect_of_the_user_is_asked_for_and_then_there(changed, content, experiment, tmp_path):
    path = tmp_path / "magnet.py"
    path.write_text(
        '"""A magnet."""\n'
        "from teleopdesign.effects import Effect, Parameter\n"
        'EFFECT = Effect(role="force", law=lambda now, p: p.pull * now.position, linear=True,\n'
        '    parameters={"pull": Parameter("stiffness", "its pull")}, absent={"pull": 0.0},\n'
        '    source="a test")\n'
    )
    models = copy.deepcopy(content["models"])
    for row in (*models["ladder"], models["estimated"]):
        row["device"]["effects"]["magnet"] = {"pull": {"value": 2.0, "unit": "N*m/rad"}}
    file = changed(models=models)
    with pytest.raises(ExperimentError, match='no effect "magnet".*give its file with --effect'):
        load_answer(file)
    model = load_answer(file, catalogue([path]), experiment=experiment).model
    assert model.parameters["device.magnet.pull"].value == 2.0


def test_a_modelled_environment_comes_back(tmp_path):
    text = PAIR.replace('axis = "prismatic"', 'axis = "prismatic"\ninertia = 0.3').replace(
        'axis = "revolute"', 'axis = "revolute"\ninertia = 2e-4'
    )
    (tmp_path / "experiment.toml").write_text(text)
    (tmp_path / "fit.csv").write_text(rows({n: range(400) for n in ("x_m", "u_m", "x_s", "u_s")}))
    experiment = td.load_experiment(tmp_path)
    model = Model.from_experiment(experiment)
    model = model.with_values({"environment.stiffness": Value(3.0, stderr=0.1)})
    data = json.loads(json.dumps(model_data(model)))
    assert_same(model_from(data, EFFECTS, "models"), model)
    assert model.places[-1] == "environment"
    older = {
        "verdict": "undecided", "missing": [], "noise_floor": 0.1, "indistinguishable": [],
        "ladder": [{"added": None, "fit_error": 0.2, "check_error": 0.2}], "candidates": [],
        "model_parameters": {
            n: {"value": v.value, "stderr": None if v.stderr != v.stderr else v.stderr,
                "unit": model.unit(n)} for n, v in model.parameters.items()
        },
    }  # fmt: skip
    write_json(tmp_path / "older.json", older)
    assert_same(load_answer(tmp_path / "older.json", experiment=experiment).model, model)
    assert load_answer(tmp_path / "older.json").model.body("environment").axis == "revolute"


KEYS = {
    "verdict": ({"verdict": "maybe"}, 'verdict: found "maybe", expected "effects_missing" or'),
    "ladder": ({"ladder": []}, "ladder: found 0 entries, expected 1 or more"),
    "no error": ({"ladder": [{"added": None}]}, r'ladder\[1\]: no key "fit_error"'),
    "negative": ({"noise_floor": -1}, "noise_floor: found -1, expected a finite number, 0 or more"),
    "huge": ({"noise_floor": 10**400}, "noise_floor: found inf, expected a finite"),
    "true": ({"noise_floor": True}, "noise_floor: found true, expected a finite number"),
    "null": ({"candidates": None}, "candidates: found null, expected a list"),
}


@pytest.mark.parametrize("key", KEYS)
def test_a_wrong_key_is_named_with_its_value_and_what_was_expected(key, changed):
    values, message = KEYS[key]
    with pytest.raises(ExperimentError, match=message):
        load_answer(changed(**values))


@pytest.mark.parametrize("command", ["design", "describe", "next", "passivity"])
def test_every_command_refuses_the_answer_to_another_experiment(command, path, capsys):
    assert main([command, str(td.example("rod")), "--answer", str(path)]) == 2
    error = capsys.readouterr().err
    assert "is not an answer to rod but to another experiment: title" in error
    assert error.count("\n") == 1
