"""How a state is written: numbers to some digits, a place a line, what is kept of an answer."""

import importlib.util
import json
import sys
from pathlib import Path

import pytest

GOLDEN = Path(__file__).parents[2] / "golden"


@pytest.fixture(scope="module")
def modules():
    """Modules of golden/ by name; their folder is no package."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(GOLDEN))
        loaded = {}
        for name in ("answers", "compare", "pieces", "freeze"):
            spec = importlib.util.spec_from_file_location(name, GOLDEN / f"{name}.py")
            loaded[name] = sys.modules[name] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(loaded[name])
        yield loaded
        for name in loaded:
            del sys.modules[name]


def test_what_is_written_reads_back_with_the_digits_that_are_kept(modules):
    freeze = modules["freeze"]
    state = {"a": [0.123456789, 2, None, True], "b": {"text": ["x", "y" * 200]}, "c": float("nan")}
    text = freeze.lines(freeze.rounded(state, 4))
    assert json.loads(text) == {
        "a": [0.1235, 2, None, True],
        "b": {"text": ["x", "y" * 200]},
        "c": "nan",
    }
    assert max(map(len, text.splitlines())) < 240, "a long text has a line of its own"


def test_an_answer_is_kept_as_it_is_judged(modules):
    candidate = {
        "effect": "bias",
        "at": "device",
        "probability": 0.5,
        "refused": "it moves nothing",
        "parameters": {"level": {"value": 1.0, "stderr": 0.1, "unit": "N"}},
    }
    answer = {
        "verdict": "undecided",
        "reading": ["..."],
        "candidates": [candidate] * 9,
        "model_parameters": {"inertia": {"value": 2.0, "stderr": None, "unit": "kg"}},
        "experiment": {"digest": "abc", "folder": "/here"},
    }
    judged = modules["answers"].kept(answer)
    assert judged["verdict"] == "undecided" and judged["digest"] == "abc"
    assert judged["model_parameters"] == {"inertia": {"value": 2.0, "stderr": None}}
    assert len(judged["candidates"]) == 5 and "reading" not in judged
    assert judged["candidates"][0] == {
        "effect": "bias",
        "at": "device",
        "probability": 0.5,
        "is_refused": True,
        "parameters": {"level": {"value": 1.0, "stderr": 0.1}},
    }


def test_a_failure_is_kept_by_its_status_and_message_and_not_by_its_place(modules):
    errors = "half way\nteleopdesign: internal error in fit/squares.py:12: LinAlgError: no"
    failure = modules["answers"].failure(70, errors, Path("/somewhere/rod"))
    assert failure == {"status": 70, "said": "teleopdesign: internal error: LinAlgError: no"}
    assert modules["answers"].kept(failure) == failure


def test_a_hash_tells_two_states_of_a_folder_apart(modules, tmp_path):
    digest_of = modules["answers"].digest_of
    (tmp_path / "a.py").write_text("x = 1\n")
    before = digest_of([tmp_path])
    (tmp_path / "__pycache__").mkdir()
    (tmp_path / "__pycache__" / "a.pyc").write_text("compiled")
    assert digest_of([tmp_path]) == before
    (tmp_path / "a.py").write_text("x = 2\n")
    assert digest_of([tmp_path]) != before


def test_what_is_not_on_this_machine_is_left_out(modules, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(modules["answers"], "SHARED", tmp_path / "nowhere")
    assert modules["freeze"].main(["answers", "--work", str(tmp_path)]) == 0
    assert "answers: left out" in capsys.readouterr().out
