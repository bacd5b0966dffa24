"""The recovery study: its rules, its counting, its plan; and that it runs (slow)."""

from __future__ import annotations

import numpy as np
import pytest
from _campaign import plan
from _defects import log_as_loggers_do
from _scoring import (
    Answer,
    Truth,
    judge,
    load_truth,
)
from shared_data import shared_folder

from teleopdesign import EFFECTS

STRIBECK, BIAS = ("stribeck", "device"), ("bias", "device")
ASYMMETRY = ("coulomb_asymmetry", "device")


def truth(*effects, level="clear", groups=(), **content):
    return Truth("0001", level, effects, tuple(frozenset(g) for g in groups), content)


def answer(*named, verdict=None, groups=(), probability=None, **content):
    verdict = verdict or ("effects_missing" if named else "undecided")
    groups = tuple(frozenset(g) for g in groups)
    return Answer(verdict, named, groups, probability or {}, {"candidates": []} | content)


ADEQUATE = answer(verdict="model_adequate")


@pytest.mark.parametrize(
    ("response", "outcome"),
    [
        (answer(STRIBECK), "right"),
        (answer(STRIBECK, BIAS), "right first"),
        (answer(BIAS, STRIBECK), "wrong"),
        (answer(("stribeck", "slave")), "other place"),
        (answer(), "undecided"),
        (answer(groups=[(STRIBECK, BIAS)]), "wide group"),
        (answer(BIAS, groups=[(STRIBECK, BIAS)]), "wide group"),
        (answer(BIAS, groups=[(STRIBECK, ASYMMETRY)]), "wrong"),
        (ADEQUATE, "missed"),
        (None, "no answer"),
    ],
)
def test_one_effect_is_judged_by_what_is_named_first_and_what_else(response, outcome):
    assert judge(truth(STRIBECK), response) == outcome


def test_an_adequate_model_called_anything_else_is_a_false_alarm():
    assert judge(truth(level="null"), ADEQUATE) == "right"
    assert judge(truth(level="null"), answer()) == "false alarm"
    assert judge(truth(level="null"), answer(BIAS)) == "false alarm"


def test_an_outside_effect_must_not_get_a_catalogue_name_with_confidence():
    hum = truth(("outside_hum", "device"), level="outside")
    assert judge(hum, answer()) == "right"
    assert judge(hum, answer(("my_hum", "device"))) == "right"
    assert judge(hum, answer(BIAS, probability={BIAS: 0.4})) == "unsure"
    assert judge(hum, answer(BIAS, probability={BIAS: 0.6})) == "confident"
    assert judge(hum, answer(BIAS)) == "confident"  # no probability: said as a fact
    assert judge(hum, ADEQUATE) == "missed"


def test_the_truth_itself_is_right_in_every_published_case():
    folder = shared_folder("hidden")
    for path in sorted((folder / "truth").glob("*.json")):
        true = load_truth(folder, path.stem)
        response = answer(*true.effects, groups=true.groups) if true.effects else ADEQUATE
        response = answer() if true.level == "outside" else response
        assert judge(true, response) == "right"


def test_a_plan_hides_every_effect_of_the_catalogue_on_both_kinds_of_machine():
    cases = plan(400, seed=1)
    contact = {"contact_damping", "contact_hardening"}
    # beside a structure, which the reference of a case does not re-estimate, or a further channel
    others = {n for n, e in EFFECTS.items() if e.role == "tip_level" or e.channels()}
    # hidden in records of their own: tests/diagnose/test_along_the_stroke.py
    others |= {"cogging_harmonic", "position_dependent_gain"}
    # tests/diagnose/test_ends_and_dead_zones.py
    others |= {"smoothed_coulomb", "stops", "actuator_dead_zone"}
    others |= {n for n, e in EFFECTS.items() if e.free}  # no candidates
    for kind, wanted in (("device", set(EFFECTS) - contact), ("teleoperator", set(EFFECTS))):
        hidden = {c.effect for c in cases if c.kind == kind and c.level == "clear"}
        assert hidden >= wanted - others
    for name in ("level", "excitation", "rate"):  # each together with each kind
        pairs = {(getattr(c, name), c.kind) for c in cases}
        assert len(pairs) == 2 * len({getattr(c, name) for c in cases})


@pytest.mark.parametrize("shift", [-1.0, 0.4, 1.0])
def test_a_logger_writes_the_command_late_and_reads_whole_steps_at_jittering_moments(shift):
    t, step = np.arange(5000) / 1000, 1e-3
    table = {"t": t, "u": t.copy(), "x": step * np.round(np.sin(t) / step), "f_h": np.cos(t)}
    log = log_as_loggers_do(table, np.random.default_rng(0), shift)
    row = np.round(1000 * log["t"])
    assert 0.99 < len(log["t"]) / len(t) < 0.9995
    assert 0.03 < np.std(1000 * log["t"] - row) < 0.06
    inside = slice(2, -2)
    assert log["u"][inside] == pytest.approx((row[inside] - shift) / 1000, abs=1e-9)
    assert np.abs(log["x"] / step - np.round(log["x"] / step)).max() < 1e-9
    assert np.abs(log["f_h"] - np.cos(log["t"])).max() < 1e-6
