"""A log without time: at which rate its velocity is the derivative of its position."""

import numpy as np
import pytest

from teleopdesign.cli import main
from teleopdesign.measurement.survey.assumed_rate import explain_rate


def motion(rate, seconds=12.0):
    """Position in rad, velocity and torque of a joint at a rate in Hz."""
    t = np.arange(int(rate * seconds)) / rate
    x = 0.8 * np.sin(2 * np.pi * 0.3 * t) + 0.2 * np.sin(2 * np.pi * 0.8 * t)
    v = np.gradient(x, t)
    return x, v, 0.2 * np.gradient(v, t) + 1.5 * np.sign(v)


@pytest.mark.parametrize("names", ["", "pos,vel,tau\n", "angle_deg,speed_rpm,tau\n"])
@pytest.mark.parametrize(("rate", "status"), [(50.0, 2), (100.0, 0)])
def test_the_guess_of_the_rate_states_that_of_the_velocity(tmp_path, capsys, names, rate, status):
    x, v, u = motion(rate)
    if "rpm" in names:
        x, v = np.degrees(x), v * 30 / np.pi
    rows = "\n".join(f"{a:.6f},{b:.6f},{c:.6f}" for a, b, c in zip(x, v, u, strict=True))
    log = tmp_path / "joint.csv"
    log.write_text(names + rows + "\n")
    assert main(["new", str(log), "--yes", "--output", str(tmp_path / "joint")]) == status
    printed = capsys.readouterr()
    text = (printed.err if status else printed.out).replace("\n", " ")
    assert f"at about {rate:g} Hz" in text
    assert ("in the unit of" in text) == ("rpm" not in names)


def test_a_velocity_that_agrees_with_the_assumed_rate_adds_nothing():
    x, v, u = motion(1000.0, 4.0)
    assert explain_rate({"a": x, "b": v, "c": u}, {}) == ""


def test_without_a_velocity_nothing_is_added():
    x, _, u = motion(100.0)
    assert explain_rate({"a": x, "b": u}, {}) == ""


def test_units_that_do_not_belong_together_tell_no_rate():
    x, v, _ = motion(100.0)
    assert explain_rate({"a": x, "b": v}, {"a": "rad", "b": "mm/s"}) == ""
    assert explain_rate({"a": x, "b": v}, {"b": "rad/s"}).endswith("unit of 'a' per second")
    assert explain_rate({"a": x, "b": v}, {"a": "rad", "b": "rad/s"}).endswith("at about 100 Hz")
