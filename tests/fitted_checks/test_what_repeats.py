"""A record that makes its motion again shows before any diagnosis what no model can explain."""

import numpy as np
import pytest
from diagnose.made_records import write_made

from teleopdesign import load_experiment
from teleopdesign.fitted_checks import check_experiment


@pytest.mark.parametrize("period", [2.5, None])
def test_a_check_states_what_differs_from_pass_to_pass(period, tmp_path):
    rates = [0.4, 0.8, 2.0] if period else [0.37, 0.83, 2.1 * np.sqrt(2.0) / 1.5]

    def path(t):
        return sum(0.3 / k * np.sin(2 * np.pi * f * t + k) for k, f in enumerate(rates, 1))

    write_made(
        tmp_path / "made",
        {"fit": [(15.0, path)]},
        lambda t, x, v: 2.0 * np.sign(v) + v + 0.8 * np.sin(9.0 * x),
        effects="coulomb = {}\nviscous = {}", step=1e-5, noise=0.3, rate=400,
    )  # fmt: skip
    findings = check_experiment(load_experiment(tmp_path / "made"))
    stated = [f for f in findings if f.topic == "what repeats"]
    assert len(stated) == (1 if period else 0)
    for finding in stated:
        numbers = finding.numbers
        assert numbers["error"] < 0.3 * numbers["left"] and numbers["share"] > 0.9
        assert f"{100 * numbers['error']:.2g} % of the force differs" in finding.sentence
