"""Files of refuting motions: what they hold is read, never run, and nothing in them takes long."""

import json

import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import dahl_compensation, positive_real, read_record, write_record

s = sp.Symbol("s")


@pytest.fixture(scope="module")
def motions(tmp_path_factory):
    """A growing wave and a cycle as plain data."""
    folder = tmp_path_factory.mktemp("motions")
    claims = {
        "wave": positive_real((s**2 - sp.Rational(1, 10) * s + 1) / (s + 1) ** 2),
        "cycle": dahl_compensation(
            coulomb_level=0.5, compensator_level=0.6, compensator_stiffness=1e4
        ),
    }
    strokes = {}
    for name, claim in claims.items():
        path = folder / f"{name}.json"
        write_record(claim.record, path)
        assert read_record(path).replay() > 0
        strokes[name] = json.loads(path.read_text())
    return strokes


@pytest.mark.parametrize(
    ("name", "key", "value"),
    [
        ("wave", "rate", "1e999999999"),
        ("wave", "frequency", "9" * 100_000),
        ("wave", "rate", 3),
        ("wave", "impedance", [["__import__('os').system('true')"]]),
        ("wave", "impedance", [["9**9**9**9"]]),
        ("wave", "velocity", [[1e308, 1e308]]),
        ("cycle", "rounds", 10**15),
        ("cycle", "rounds", -1),
        ("cycle", "rounds", "__import__('os')"),
        ("cycle", "turning_points", [0.1] * 100_000),
        ("cycle", "compensator", ["sys", "exit"]),
        ("cycle", "kind", "__class__"),
    ],
)
def test_a_spoilt_record_is_refused_in_one_line(motions, name, key, value, tmp_path):
    path = tmp_path / "motion.json"
    path.write_text(json.dumps({**motions[name], key: value}))
    with pytest.raises(ModelError) as refused:
        read_record(path)
    assert "\n" not in str(refused.value) and len(str(refused.value)) < 400


@pytest.mark.parametrize("text", ["[" * 100_000, "", "null", "[]", '{"kind": "cycle"}', "\x00"])
def test_what_is_no_record_is_refused_in_one_line(text, tmp_path):
    path = tmp_path / "motion.json"
    path.write_text(text)
    with pytest.raises(ModelError, match="no record of a motion"):
        read_record(path)
