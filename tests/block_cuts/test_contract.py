"""Sentences of the file format for whole diagrams, each on a small case."""

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.block_cuts.body import body_experiment
from teleopdesign.measurement.prepare import prepare

H = td.controller("low_pass", {"bandwidth": 15.0}).then(td.controller("gain", {"gain": 1.5}))
C = td.controller("smoothed_coulomb", {"level": 0.3, "smoothing_velocity": 0.02})
SIGNALS = ("R_D", "R_A", "R_M", "L", "R_FF", "R_MBC")


@pytest.fixture(scope="module")
def diagram():
    device = td.Body(
        "prismatic", {"inertia": 0.2, "viscous.damping": 2.0}, (td.EFFECTS["viscous"],)
    )
    held = td.hand(mass=0.1, damping=4.0, stiffness=300.0)
    return td.haptic_interface(device, hand=held, cancellation=C, force_feedback=H)


@pytest.fixture(scope="module")
def log(diagram):
    def desired(t):
        return 0.8 * np.sin(13.0 * t) + 0.6 * np.sin(31.0 * t + 1.0)

    run = td.simulate_diagram(diagram, duration=2.5, inputs={"R_D": desired})
    columns = {name: run[name].values for name in SIGNALS if name != "R_D"}
    time = run.data["time"].values
    return columns | {"R_D": desired(time), "t": time}


def experiment(diagram, log, *signals, outside=("R_V",), **more):
    channels = {n: {"column": n, "unit": "m" if n == "L" else "N"} for n in signals}
    for name, extra in more.items():
        channels[name] |= extra
    channels["time"] = {"column": "t", "unit": "s"}
    return td.diagram_experiment(
        diagram, log, channels=channels, outside=outside, sample_period=1e-3, bandwidth=60
    )


def body_of(made, name):
    (cut,) = [c for c in made.cuts.tested if c.name == name]
    return prepare(body_experiment(made, cut))


def test_below_the_line_stand_recorded_forces_only(diagram, log):
    """Without R_A the error of Z_M is relative to R_M, not to the command of the laws."""
    whole = body_of(experiment(diagram, log, "R_D", "R_M", "L"), "Z_M")
    (stretch,) = whole.stretches
    low = stretch.motion.lowpassed(log["R_M"])[stretch.keep]
    assert stretch.measured == pytest.approx(stretch.weight * np.sum(low**2), rel=0.01)
    neither = body_of(experiment(diagram, log, "R_D", "R_A", "L"), "Z_M").stretches[0]
    low = neither.motion.lowpassed(neither.motion.at_rows(log["R_A"]))[neither.keep]
    assert neither.measured == pytest.approx(neither.weight * np.sum(low**2), rel=0.01)


def test_the_error_of_a_hand_is_relative_to_its_force_whatever_pushes_beside(diagram, log):
    pushed = {**log, "R_V": 5.0 + np.sin(3.0 * log["t"])}
    made = experiment(diagram, pushed, "R_A", "R_M", "L", "R_V", outside=())
    (stretch,) = body_of(made, "Z_H").stretches
    low = stretch.motion.lowpassed(log["R_M"])[stretch.keep]
    assert stretch.measured == pytest.approx(stretch.weight * np.sum(low**2), rel=0.01)


def test_the_sum_of_device_and_hand_needs_a_known_push(diagram, log):
    known = experiment(diagram, log, "R_D", "R_A", "L")
    assert {c.name for c in known.cuts.tested} == {"Z_M"}
    with pytest.raises(td.ExperimentError, match="R_V"):
        experiment(diagram, log, "R_A", "L", outside=())


@pytest.mark.parametrize(("sign", "verdict"), [(1, "model_adequate"), (-1, "undecided")])
def test_a_sum_whose_terms_are_recorded_tests_wiring_and_sign(diagram, log, sign, verdict):
    signals = ("R_D", "R_A", "R_FF", "R_MBC")
    made = experiment(diagram, log, *signals, R_MBC={"sign": sign})
    assert [c.name for c in made.cuts.of("wiring")] == ["R_A"]
    diagnosis = td.find_missing(made, at=["R_A"])
    assert diagnosis.verdict == verdict and not diagnosis.missing
    errors = diagnosis.answer()["ladder"][-1]["cuts"]
    assert (errors["R_A"] < 1e-9) == (sign == 1)


def test_a_floor_is_never_below_the_last_digit_of_its_column(diagram, log):
    coarse = {**log, "R_M": np.round(log["R_M"], 2)}
    made = experiment(diagram, coarse, "R_A", "R_M", "L", R_M={"noise": 1e-4})
    (cut,) = [c for c in made.cuts.tested if c.name == "Z_H"]
    force = body_experiment(made, cut).channels["Z_H.actuator_force"]
    assert force.resolution == pytest.approx(0.01)


@pytest.mark.parametrize(("rows", "what"), [((899, 900, 900), "twice")])
def test_the_reason_why_laws_are_untested_stands_once(diagram, log, rows, what):
    before, after = np.arange(rows[0]), np.arange(rows[-1] + 1, len(log["R_A"]))
    every = np.concatenate([before, rows, after])
    changed = {name: values[every] for name, values in log.items()}
    made = experiment(diagram, changed, "R_A", "R_D", "R_M", "L")
    with pytest.raises(td.ExperimentError, match=r"a row is .* at 0\.(899|9) s") as error:
        td.find_missing(made, at=["R_A"])
    assert str(error.value).count(what) == 1


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"R_M": lambda log: 1000.0 * log["R_M"]}, "channels.R_M: with 0.001 times"),
        pytest.param(
            {"R_D": lambda log: log["R_M"], "R_M": lambda log: log["R_D"]},
            "exchanged",
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_column_that_all_cuts_want_otherwise_stops_the_diagnosis(diagram, log, change, words):
    """Else every block takes up the factor, and four of them are named."""
    changed = log | {name: made(log) for name, made in change.items()}
    recorded = experiment(diagram, changed, "R_D", "R_A", "R_M", "L")
    with pytest.raises(td.ExperimentError, match=words):
        td.find_missing(recorded)


@pytest.mark.parametrize("factor", [1.3])
def test_a_scale_that_a_block_may_have_is_no_wrong_unit(diagram, log, factor):
    from teleopdesign.block_cuts.channel_doubts import doubt_channels

    changed = log | {"R_M": factor * log["R_M"]}
    assert not doubt_channels(experiment(diagram, changed, "R_D", "R_A", "R_M", "L"))
