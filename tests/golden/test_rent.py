"""The table of rules that decide: every rule is there, and the table counts what it is told."""

import importlib.util
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def rent():
    spec = importlib.util.spec_from_file_location("rent", ROOT / "golden" / "rent.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_rule_is_a_function_of_the_diagnosis(rent):
    for name, _ in rent.RULES.values():
        module, function = rent._function(name)
        assert callable(getattr(module, function)), name


def test_a_rule_decides_rightly_where_the_answer_without_it_is_further_from_the_truth(rent):
    right, wrong = ({"named": [n], "verdict": "v", "seconds": 2.0} for n in ("a at b", "c at b"))
    cases = {"one": {"with": right, "fired": {"swap": 2}, "without": {"swap": wrong}}}
    line = next(x for x in rent.table(cases, {"one": {"a at b"}}).splitlines() if "swap" in x)
    assert line.split() == ["swap", "1", "1", "1", "0", "0", "one"]
    alone = next(x for x in rent.table(cases, {}).splitlines() if "swap" in x)
    assert alone.split() == ["swap", "1", "1", "0", "0", "0", "one"], "no truth is known"
