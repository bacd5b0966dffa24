"""No experiment, record, answer or effect file runs what a text of it says."""

import ast
import json
import os
import pickle
import sys
from types import SimpleNamespace

import numpy as np
import pytest
from clock import in_time
from measurement.rod_example import ROD, rod_columns, rows, write_rod
from security.diagram_file import one_line
from security.hostile import CODE, MARK, pairs, quoted

from teleopdesign.base.errors import ExperimentError, TeleopDesignError
from teleopdesign.cli import main
from teleopdesign.effects import load_effect
from teleopdesign.measurement import load_experiment

pytest.importorskip("h5py")  # asks the machine what it is when it is first loaded

#: what stands in an experiment's file
ENTRIES = (
    '"Vertical rod of a one-axis haptic interface"', '"prismatic"', "0.15", '"kg"', "false",
    "coulomb", "level", "device", '"t"', '"u"', '"mm"', "actuator_force", "5e-3", "20", '"Hz"',
    '"fit.csv"', '"check"', '"own"',
)  # fmt: skip
TITLE = ENTRIES[0]


@pytest.mark.parametrize(("entry", "text"), pairs(ENTRIES, CODE[:12]))
def test_an_entry_of_an_experiment_is_refused_or_stays_a_text(guard, tmp_path, entry, text):
    folder = write_rod(tmp_path / "rod")
    file = folder / "experiment.toml"
    file.write_text(ROD.replace(entry, quoted(text), 1), encoding="utf-8")
    with in_time():
        if entry == TITLE:
            assert load_experiment(folder).title == text
            return
        with pytest.raises(TeleopDesignError) as caught:
            from teleopdesign.model import Model

            Model.from_experiment(load_experiment(folder))
    one_line(caught.value)


@pytest.mark.parametrize("text", [t for t in CODE if t.strip() == t and t and "\n" not in t])
def test_a_column_may_be_called_anything(guard, tmp_path, text):
    """A header is looked up as it stands, where a line of the table can hold it."""
    folder = write_rod(tmp_path / "rod")
    toml = ROD.replace('"x"', quoted(text))
    (folder / "experiment.toml").write_text(toml, encoding="utf-8")
    for name in ("fit.csv", "check.csv"):
        columns = rod_columns()
        columns = {
            f'"{text}"' if k == "x" and '"' not in text else k: v for k, v in columns.items()
        }
        (folder / name).write_text(rows(columns), encoding="utf-8")
    with in_time():
        try:
            experiment = load_experiment(folder)
            assert experiment.channels["device.position"].column == text
        except ExperimentError as error:
            one_line(error)


class Runs:
    """What a pickle of it does when it is read."""

    def __reduce__(self):
        return (__import__("os").putenv, (MARK, "1"))


@pytest.mark.parametrize(
    "name", ["r.csv", "r.csv.gz", "r.mat", "r.h5", "r.parquet", "r.npz", "r.pkl"]
)
@pytest.mark.parametrize("kind", ["pickle", "npz", "mat"])
def test_a_record_that_holds_objects_is_refused_in_one_line(
    guard, tmp_path, monkeypatch, name, kind
):
    from scipy.io import savemat

    def refuse(*_, **__):
        raise AssertionError("a pickle was read")

    folder = write_rod(tmp_path / "rod")
    (folder / "experiment.toml").write_text(ROD.replace("fit.csv", name))
    content = np.array([Runs()] * 100, dtype=object)
    file = folder / name
    if kind == "pickle":
        file.write_bytes(pickle.dumps(content))
    elif kind == "npz":
        with file.open("wb") as stream:
            np.savez(stream, t=content, u=content, x=content, f_h=content)
    else:
        with file.open("wb") as stream:
            savemat(
                stream, {n: np.array([{"a": 1}, "b"], dtype=object) for n in ("t", "u", "x", "f_h")}
            )
    for read in ("load", "loads", "Unpickler"):
        monkeypatch.setattr(pickle, read, refuse)
    with in_time(), pytest.raises(ExperimentError) as caught:
        load_experiment(folder)
    one_line(caught.value)


def number(value, unit="N"):
    return {"value": value, "stderr": 0.01, "unit": unit}


def answer(**changed):
    """An answer of a diagnosis in which one thing is another text."""
    c = {
        "verdict": "effects_missing",
        "effect": "presliding",
        "at": "device",
        "body": "device",
        "parameter": "coulomb.level",
        "own": "stiffness",
        "value": 0.5,
        "stderr": 0.01,
        "unit": "kg",
    } | changed
    inertia = {"value": c["value"], "stderr": c["stderr"], "unit": c["unit"]}
    place = {"effect": c["effect"], "at": c["at"]}
    return {
        "verdict": c["verdict"],
        "missing": [place],
        "ladder": [{"added": None}, {"added": place}],
        "model_parameters": {
            f"{c['body']}.inertia": inertia,
            "device.coulomb.level": number(0.5),
            f"device.{c['parameter']}": number(0.4),
        },
        "candidates": [{**place, "parameters": {c["own"]: number(2e4, "N/m")}}],
    }


@pytest.mark.parametrize(
    ("key", "text"),
    pairs(("effect", "at", "body", "parameter", "own", "value", "stderr"), CODE[:12]),
)
def test_an_entry_of_an_answer_is_refused_in_one_line(guard, tmp_path, capsys, key, text):
    from teleopdesign.diagnose import load_answer

    path = tmp_path / "answer.json"
    path.write_text(json.dumps(answer(**{key: text})))
    with in_time():
        assert main(["passivity", str(path), "--dahl", "0.4", "1e4"]) == 2
        output = capsys.readouterr().err
        assert output.count("\n") == 1 and one_line(output.strip())
        with pytest.raises(ExperimentError) as caught:
            load_answer(path, experiment=load_experiment(write_rod(tmp_path / "rod")))
    one_line(caught.value)


TITLES = (*CODE, '"' * 7, "\\", "\\N{x}", '\\"""', "'''" + '"""')


@pytest.mark.parametrize("text", TITLES, ids=range(len(TITLES)))
def test_a_written_effect_file_holds_titles_as_text_alone(tmp_path, monkeypatch, text):
    """It is code that is run later: titles and sentences with file names stand in its docstring."""
    from teleopdesign.unexplained import effect_file
    from teleopdesign.unexplained.shapes import SHAPES

    shape = next(s for s in SHAPES if s.variable is None and s.carrier.name == "force")
    dependence = SimpleNamespace(
        shape=shape, explained=0.5, coefficients=np.array([0.3]), knots=np.array([0.0])
    )
    curve = SimpleNamespace(x=np.array([0.0, 1.0]))
    described = SimpleNamespace(dependence=dependence, formula=None, sentence=text, curve=curve)
    experiment = SimpleNamespace(title=text)
    prepared = SimpleNamespace(experiment=experiment, of=lambda use: (), bandwidth=20.0)
    monkeypatch.setattr(effect_file, "scales", lambda *_: {"force": 1.0})
    path = tmp_path / "made.py"
    effect_file.write_effect(path, SimpleNamespace(axis="prismatic"), described, prepared)
    kinds = [type(node).__name__ for node in ast.parse(path.read_text()).body]
    assert kinds == ["Expr", "ImportFrom", "FunctionDef", "Assign"]
    content = ast.parse(path.read_text())
    content.body[0] = ast.Pass()
    assert MARK not in ast.unparse(content)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(MARK, raising=False)
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    assert load_effect(path).role == "force"  # it is run here, the text in its docstring is not
    assert MARK not in os.environ and len(list(tmp_path.iterdir())) == 1
