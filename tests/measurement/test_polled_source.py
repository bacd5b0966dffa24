"""A reader polls the last state of a controller: its rows stand at the ticks of the source."""

import shutil

import numpy as np
import pytest
from diagnose.made_records import write_made

import teleopdesign as td
from teleopdesign.measurement.polled_source import polled_source

#: period of the source, mean step of the reader and the most by which a step differs, ms
POLLED = [(8.0, 10.0, 3.0), (2.0, 8.0, 1.0), (8.0, 8.0, 2.0), (8.0, 2.0, 0.5), (8.0, 20.0, 4.0)]


def motion(t):
    return 0.4 * np.sin(2 * np.pi * 0.9 * t) + 0.1 * np.sin(2 * np.pi * 4.1 * t)


def command(t):
    return 0.3 * np.sin(2 * np.pi * 1.3 * t) + 0.1 * np.cos(2 * np.pi * 6.0 * t)


def read_at(step, spread, rng, duration=8.0):
    """Instants of a reader whose steps differ by up to `spread`, s."""
    return 5.0 + np.cumsum(step + spread * rng.uniform(-1.0, 1.0, int(duration / step)))


def rows_at(instants, step=1e-4):
    q = step * np.round(motion(instants) / step)
    u = command(instants)
    return q, u, np.r_[False, (np.diff(q) == 0) & (np.diff(u) == 0)]


@pytest.mark.parametrize(("period", "step", "spread"), POLLED)
@pytest.mark.parametrize("seed", [1, 2])
def test_each_row_stands_at_its_tick_of_the_source(period, step, spread, seed):
    rng = np.random.default_rng(seed)
    stamps = read_at(1e-3 * step, 1e-3 * spread, rng)
    true = 1e-3 * period * (1.0 + 1e-4 * rng.standard_normal())
    instants = true * (np.floor(stamps / true - 0.37) + 0.37)
    q, _, same = rows_at(instants)
    source = polled_source(stamps, same, [q])
    assert source.period == pytest.approx(true, rel=1e-4)
    # one row in a hundred may have its stamp so near to a tick that it falls on the other side
    assert np.mean(np.abs(source.instants - instants) < 0.1 * true) > 0.99


@pytest.mark.parametrize(("step", "spread"), [(10.0, 3.0), (2.0, 0.5)])
def test_a_long_log_with_a_pause_keeps_its_ticks_to_the_end(step, spread):
    rng = np.random.default_rng(5)
    stamps = np.cumsum(1e-3 * (step + spread * rng.uniform(-1.0, 1.0, 24_000)))
    stamps[12_000:] += 30.0
    instants = 8e-3 * np.floor(stamps / 8e-3)
    q, _, same = rows_at(instants)
    source = polled_source(stamps, same, [q])
    assert np.mean(np.abs(source.instants - instants) < 1e-3) > 0.99


def test_a_stamp_that_is_far_away_takes_no_memory():
    t = np.append(np.arange(3000) / 1000.0, 1e15)
    assert polled_source(t, np.zeros(3001, dtype=bool), [motion(t)]) is None


@pytest.mark.parametrize(
    ("step", "spread"), [(10.0, 3.0), (8.0, 1.0), (2.0, 0.6), (1.0, 0.05), (2.0, 0.0)]
)
@pytest.mark.parametrize("are_true", [True, False])
@pytest.mark.parametrize("encoder", [1e-4, 3e-3])
def test_a_log_that_polls_nothing_is_left_as_it_is(step, spread, are_true, encoder):
    """Stamps that are true, and stamps that are only late: neither is a source that is polled."""
    rng = np.random.default_rng(3)
    stamps = read_at(1e-3 * step, 1e-3 * spread, rng)
    even = stamps[0] + 1e-3 * step * np.arange(len(stamps))
    q, _, same = rows_at(stamps if are_true else even, encoder)
    assert polled_source(stamps, same, [q]) is None


@pytest.mark.parametrize("lost", [0.0, 0.005])
def test_late_stamps_of_an_even_clock_are_no_polling(lost):
    """Each row is a tick of such a clock: what is said of late stamps says it all."""
    rng = np.random.default_rng(4)
    even = np.arange(3000) / 500.0
    even = even[rng.random(3000) >= lost]
    stamps = even + 0.1 / 500.0 * rng.standard_normal(len(even))
    q, _, same = rows_at(even)
    assert polled_source(stamps, same, [q]) is None


def test_an_encoder_that_turns_evenly_polls_nothing():
    t = np.arange(8000) / 1000.0
    q = 1e-3 * np.floor(0.12 * t / 1e-3)
    assert polled_source(t, np.r_[False, np.diff(q) == 0], [q]) is None


def test_a_body_that_rests_has_lost_no_rows():
    rng = np.random.default_rng(4)
    stamps = read_at(10e-3, 3e-3, rng)
    instants = 8e-3 * np.floor(stamps / 8e-3)
    moving = np.clip(instants, None, 9.0) + np.clip(instants - 10.0, 0.0, None)
    q, u, _ = rows_at(moving)
    record = td.experiment(
        {"t": stamps, "q": q, "u": u},
        axis="revolute",
        position="q",
        actuator_force="u",
        inertia=0.01,
    ).records[0]
    assert len(record.segments) == 1
    assert record.sample_time == pytest.approx(8e-3, rel=1e-4)


def friction(t, x, v):
    """0.3 N m of Coulomb, 0.4 more at rest down to 1/e at 0.2 rad/s, 0.1 N m s/rad."""
    return np.sign(v) * (0.3 + 0.4 * np.exp(-((v / 0.2) ** 2))) + 0.1 * v


EFFECTS = """coulomb.level = { value = 0.4, unit = "N*m" }
viscous.damping = { value = 0.05, unit = "N*m*s/rad" }"""
#: seconds, and position over time
RECORDS = {
    "fit": [(24.0, lambda t: 0.5 * np.sin(1.9 * t) + 0.2 * np.sin(4.7 * t))],
    "check": [(16.0, lambda t: 0.4 * np.sin(2.3 * t) + 0.25 * np.sin(3.9 * t + 1.0))],
}


def diagnosed(folder):
    return td.find_missing(td.load_experiment(folder), among=("stribeck", "presliding", "bias"))


def poll(clean, folder, period, step, spread):
    """The same experiment as a reader has it that polls what the controller wrote."""
    shutil.copytree(clean, folder)
    toml = (folder / "experiment.toml").read_text()
    (folder / "experiment.toml").write_text(toml.replace('segment = { column = "part" }\n', ""))
    rng = np.random.default_rng(1)
    for use, ((duration, _),) in RECORDS.items():
        ticks = np.loadtxt(clean / f"{use}.csv", delimiter=",", skiprows=1)
        stamps = read_at(step, spread, rng, duration) - 5.0
        stamps = stamps[stamps < len(ticks) * period]
        row = np.floor(stamps / period).astype(int)
        rows = np.column_stack([stamps, ticks[row, 1:3]])
        np.savetxt(folder / f"{use}.csv", rows, "%.9g", ",", header="t,q,tau", comments="")
    return folder


@pytest.mark.slow
@pytest.mark.parametrize(("period", "step", "spread"), [(8e-3, 10e-3, 3e-3), (2e-3, 8e-3, 1e-3)])
def test_a_polled_log_has_the_answer_of_the_clean_record(period, step, spread, tmp_path):
    rate = round(1.0 / period)
    words = {"effects": EFFECTS, "step": 1e-4, "noise": 0.003, "rate": rate}
    clean = write_made(tmp_path / "clean", RECORDS, friction, **words)
    polled = poll(clean, tmp_path / "polled", period, step, spread)
    truth, answer = diagnosed(clean), diagnosed(polled)
    assert [c.key for c in truth.missing] == [("stribeck", "device")]
    assert answer.missing == truth.missing and answer.verdict == truth.verdict
    for name, value in truth.model.parameters.items():
        also = answer.model.parameters[name]
        within = 1.96 * (value.stderr**2 + also.stderr**2) ** 0.5
        assert abs(value.value - also.value) <= within, name
