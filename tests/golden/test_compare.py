"""What counts as a difference between two frozen states."""

import importlib.util
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def compare():
    path = ROOT / "golden" / "compare.py"
    spec = importlib.util.spec_from_file_location("golden_compare", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


STATE = {
    "001": {
        "verdict": "effects_missing",
        "ladder": [{"fit_error": 0.0123456, "added": None}],
        "model_parameters": {"inertia": {"value": 0.2, "stderr": 1e-3}},
        "candidates": [{"effect": "stribeck", "probability": 0.97, "parameters": {}}],
    },
    "002": {"status": 70, "said": "internal error"},
}


def moved(**changes):
    """The state with values at places such as "001/verdict" replaced."""
    state = json.loads(json.dumps(STATE))
    for place, value in changes.items():
        *way, last = [int(k) if k.isdigit() and len(k) < 3 else k for k in place.split("/")]
        inner = state
        for key in way:
            inner = inner[key]
        inner[last] = value
    return state


@pytest.mark.parametrize(
    ("change", "place"),
    [
        ({"001/verdict": "undecided"}, "001/verdict: 'effects_missing' -> 'undecided'"),
        ({"001/ladder/0/fit_error": 0.01234563}, "001/ladder/0/fit_error: 0.0123456 -> "),
        ({"001/ladder": []}, "001/ladder: "),
        ({"001/ladder/0/added": "bias"}, "001/ladder/0/added: None -> 'bias'"),
        ({"001/model_parameters/inertia/value": 0.200002}, "001/model_parameters/inertia/value"),
        ({"001/model_parameters/inertia/stderr": 1.001e-3}, "001/model_parameters/inertia/stderr"),
        ({"001/candidates/0/effect": "bias"}, "001/candidates/0/effect"),
        ({"001/candidates/0/probability": 0.9}, "001/candidates/0/probability"),
        ({"002/status": 0}, "002/status"),
        ({"003": {}}, "003: only after"),
    ],
)
def test_what_moved_is_reported_with_its_place(compare, tmp_path, change, place):
    before, after = tmp_path / "answers.json", tmp_path / "new.json"
    before.write_text(json.dumps(STATE))
    after.write_text(json.dumps(moved(**change)))
    (line,) = compare.between(before, after)
    assert line.startswith(f"answers/{place}")
    assert compare.main(before, after) == 1


def test_rounding_and_a_small_part_of_a_standard_error_are_no_difference(compare, tmp_path):
    before, after = tmp_path / "answers.json", tmp_path / "new.json"
    before.write_text(json.dumps(STATE))
    near = {
        "001/ladder/0/fit_error": 0.01234560001,
        "001/model_parameters/inertia/value": 0.2000005,  # of an error of 0.001
        "001/model_parameters/inertia/stderr": 1.00001e-3,
        "001/candidates/0/probability": 0.9701,
    }
    after.write_text(json.dumps(moved(**near)))
    assert compare.between(before, after) == [] and compare.main(before, after) == 0


def test_numbers_of_a_row_are_compared_with_the_whole_row(compare):
    before, after = [0.0, 1e-14, 2.0], [1e-13, 0.0, 2.0]
    assert not list(compare.differences(before, after, near=1e-12))
    assert len(list(compare.differences(before, [0.0, 1e-3, 2.0], near=1e-12))) == 1


def test_a_part_that_was_never_frozen_is_a_difference(compare, tmp_path):
    (tmp_path / "new.json").write_text("{}")
    assert compare.between(tmp_path / "logs.json", tmp_path / "new.json")
