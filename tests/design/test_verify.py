"""A second recording with the compensation on, of a device that shares no code with the package."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.blocks import Value
from teleopdesign.cli import main
from teleopdesign.design.verify import Plan, read_plan, verify

PERIOD, LEVEL, STEP, INERTIA = 1e-3, 0.3, 2e-4, 0.01
COGGING = {"amplitude": 0.1, "period": 0.5712, "phase": 0.3}
SMOOTH, BANDWIDTH = 0.2, 50.0


def device(level=LEVEL):
    body = td.Body("revolute", {"inertia": INERTIA})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": level})
    body = body.with_effect(td.EFFECTS["viscous"], {"damping": 0.02})
    body = body.with_effect(td.EFFECTS["cogging"], COGGING)
    errors = {"coulomb.level": 0.004, "cogging.amplitude": 0.002, "viscous.damping": 0.001}
    return body.with_values(
        {n: Value(body.parameters[n].value, stderr=e) for n, e in errors.items()}
    )


def plan():
    effects = {"coulomb": {"level": 0.27}, "cogging": COGGING}
    law = td.cancel(effects, smoothing_velocity=SMOOTH)
    diagram = td.haptic_interface(device(), cancellation=law)
    sampling = td.Sampling(
        period=PERIOD, delay=PERIOD, encoder_step=STEP, velocity_bandwidth=BANDWIDTH
    )
    return Plan(diagram, sampling, "device", "MBC", 0.0)


def recorded(level=LEVEL, zero=0.0):
    """The hand's force along a motion, by formulas: held command of a filtered difference.

    zero: shift of the compensator's position against the device's, rad
    """
    inner = 10
    t = np.arange(0, 12, PERIOD / inner)
    w1, w2 = 2 * np.pi * 0.35, 2 * np.pi * 0.83
    x = 0.8 * np.sin(w1 * t) + 0.3 * np.sin(w2 * t + 0.4)
    v = 0.8 * w1 * np.cos(w1 * t) + 0.3 * w2 * np.cos(w2 * t + 0.4)
    a = -0.8 * w1**2 * np.sin(w1 * t) - 0.3 * w2**2 * np.sin(w2 * t + 0.4)

    def cogging(place):
        return COGGING["amplitude"] * np.sin(
            2 * np.pi * place / COGGING["period"] + COGGING["phase"]
        )

    reading = np.round(x[::inner] / STEP) * STEP
    rate = np.diff(reading, prepend=reading[0]) / PERIOD
    part, speed = 1 - np.exp(-2 * np.pi * BANDWIDTH * PERIOD), np.zeros(len(rate))
    for k in range(1, len(rate)):
        speed[k] = speed[k - 1] + part * (rate[k] - speed[k - 1])
    command = 0.27 * speed / (SMOOTH + np.abs(speed)) + cogging(reading - zero)
    acting = np.repeat(np.concatenate([[0.0], command[:-1]]), inner)
    hand = INERTIA * a + 0.02 * v + level * np.sign(v) + cogging(x) - acting
    columns = {"t": t[::inner], "x": reading, "u": command, "f": hand[::inner]}
    return td.experiment(
        columns,
        axis="revolute",
        position={"column": "x", "unit": "rad", "resolution": STEP},
        actuator_force={"column": "u", "unit": "N*m"},
        interaction_force={"column": "f", "unit": "N*m"},
        time={"column": "t", "unit": "s"},
        inertia=INERTIA,
    )


@pytest.fixture(scope="module")
def right():
    return verify(plan(), recorded())


def test_the_measured_error_of_the_designed_device_lies_in_the_interval(right):
    assert right.holds and right.high < 0.5 * right.without
    assert "within" in str(right)
    np.testing.assert_allclose(right.rows["measured"], right.rows["predicted"], atol=0.12)


@pytest.mark.parametrize("changed", [{"level": 0.6}, {"zero": 0.25}])
def test_a_device_or_a_zero_that_changed_is_outside(changed):
    wrong = verify(plan(), recorded(**changed))
    assert not wrong.holds and "outside" in str(wrong)


def test_before_and_after_are_drawn_on_one_scale(right):
    before, after = right.plot().axes
    assert before.get_ylim() == after.get_ylim()
    assert len(after.lines) == 2


@pytest.mark.slow
def test_the_file_of_a_design_holds_the_plan(designed, tmp_path):
    designed.to_json(tmp_path / "design.json")
    read, plan_of_it = read_plan(tmp_path / "design.json"), Plan.of(designed)
    assert read.diagram == plan_of_it.diagram and read.sampling.period == PERIOD
    assert (read.place, read.case) == (plan_of_it.place, plan_of_it.case)


@pytest.mark.parametrize(
    "text, part", [("no json", "cannot be read as a design"), ('{"bodies": {"arm": {}}}', "arm")]
)
def test_a_file_that_is_no_design_is_one_line(text, part, tmp_path, capsys):
    (tmp_path / "d.json").write_text(text)
    assert main(["verify", str(tmp_path / "d.json"), str(td.example("rod"))]) == 2
    line = capsys.readouterr().err
    assert part in line and line.count("\n") == 1
