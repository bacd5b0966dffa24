"""The truth simulator, against conservation laws, closed forms and scipy."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import truth_simulator as ts
from cases import make_case, write_case
from excitation import fit_record
from reference import lowpass, triangle
from scipy.integrate import solve_ivp

RATE = 1000.0


def driven(samples: int, seed: int = 3, force: float = 1.5) -> ts.Drive:
    """A force that starts, stops and reverses a body."""
    rng = np.random.default_rng(seed)
    t = np.arange(samples) / RATE
    drive = ts.Drive.zero(samples)
    for f in (0.9, 2.3, 5.1, 11.0):
        drive.feedforward[:, 0] += force / 2 * np.sin(2 * np.pi * f * t + rng.uniform(0, 6))
    drive.direct[:, 0] = 0.4 * force * np.sin(2 * np.pi * 1.7 * t)
    return drive


def closed_loop(inner: int, resolution: float, **more: float) -> ts.Motion:
    rng = np.random.default_rng(5)
    x, v = fit_record(rng, RATE, 3.0, "normal", 18.0)
    drive = ts.Drive.zero(len(x))
    drive.reference[:, 0], drive.reference_velocity[:, 0] = 0.01 * x, 0.01 * v
    p = ts.body(
        inertia=0.2, level=0.4, damping=1.0, bristle_stiffness=1.5e5, bristle_damping=50.0,
        kp=390.0, kd=14.0, resolution=resolution, **more,
    )  # fmt: skip
    return ts.simulate([p], drive, RATE, inner)


DAHL = {"inertia": 0.2, "level": 0.5, "damping": 0.8, "bristle_stiffness": 3000.0}


def dahl_by_scipy(drive: ts.Drive, samples: int, p: dict[str, float], spring: float) -> np.ndarray:
    """The same machine as one ODE, in pieces between the rows; states x, v, f."""
    state = np.zeros(3)
    out = [state]
    for k in range(samples - 1):
        u = drive.feedforward[k, 0]
        d0, d1 = drive.direct[k : k + 2, 0]

        def rhs(
            t: float, s: np.ndarray, u: float = u, d0: float = d0, d1: float = d1
        ) -> list[float]:
            x, v, f = s
            net = u + d0 + (d1 - d0) * t * RATE - f - p["damping"] * v - spring * x
            bristle = p["bristle_stiffness"] * (v - abs(v) * f / p["level"])
            return [v, net / p["inertia"], bristle]

        s = solve_ivp(rhs, (0, 1 / RATE), state, method="Radau", rtol=1e-10, atol=1e-13)
        state = s.y[:, -1]
        out.append(state)
    return np.array(out)


def test_agrees_with_radau_on_a_dahl_device() -> None:
    n = 400
    drive = driven(n)
    want = dahl_by_scipy(drive, n, DAHL, 30.0)
    got = ts.simulate([ts.body(**DAHL, spring=30.0)], drive, RATE, 100)
    size, force = np.abs(want[:, 0]).max(), np.abs(want[:, 2]).max()
    assert np.abs(np.diff(np.sign(want[:, 1]))).sum() > 4  # it reverses
    assert np.abs(got.rows("x")[:, 0] - want[:, 0]).max() < 1e-7 * size
    assert np.abs(got.rows("friction")[:, 0] - want[:, 2]).max() < 1e-5 * force


def test_second_order() -> None:
    drive = driven(600)
    steps = (5, 20, 640)
    runs = [ts.simulate([ts.body(**DAHL)], drive, RATE, n).rows("friction") for n in steps]
    errors = [np.sqrt(np.mean((r - runs[-1]) ** 2)) for r in runs[:-1]]
    assert errors[0] > 10 * errors[1]


def test_halving_the_step_without_encoder() -> None:
    """Hard bristle: the trajectory moves by less than a millionth of its size."""
    a, b = closed_loop(50, 0.0), closed_loop(100, 0.0)
    assert np.abs(a["x"] - b["x"]).max() < 1e-6 * np.abs(b["x"]).max()


def test_energy_balance() -> None:
    p = ts.body(
        **DAHL, spring=40.0, cogging=0.1, cogging_period=0.004, has_tip=1.0, tip_inertia=0.08,
        tip_stiffness=900.0, tip_damping=0.3,
    )  # fmt: skip
    m = ts.simulate([p], driven(2000), RATE, 50, 50)
    x, v, xt, vt = (m[n][:, 0] for n in ("x", "v", "x_tip", "v_tip"))
    dt = m.period / m.sub

    def work(power: np.ndarray) -> np.ndarray:
        return np.concatenate([[0.0], np.cumsum(0.5 * (power[1:] + power[:-1])) * dt])

    # the command is constant over each step, the speed is not: exact work is force times way
    u = m["acting"][:-1, 0]
    work_in = np.concatenate([[0.0], np.cumsum(u * np.diff(x))]) + work(m["interaction"][:, 0] * vt)
    lost = work(m["friction"][:, 0] * v + 0.8 * v**2 + 0.3 * (v - vt) ** 2)
    wave = 0.1 * 0.004 / (2 * np.pi) * (1 - np.cos(2 * np.pi * x / 0.004))
    kept = 0.1 * v**2 + 0.04 * vt**2 + 20 * x**2 + wave + 450 * (x - xt) ** 2
    assert np.abs(work_in - lost - kept).max() < 2e-4 * work_in.max()
    bristle = work(m["friction"][:, 0] * v) - 0.5 * m["friction"][:, 0] ** 2 / 3000.0
    assert np.diff(bristle).min() > -1e-9  # a bristle only dissipates


def test_stuck_body_carries_any_force_up_to_its_level() -> None:
    drive = ts.Drive.zero(1500)
    ramp = np.minimum(np.arange(1500) / 1000, 1.2)
    drive.feedforward[:, 0] = ramp
    hard = {"inertia": 0.2, "level": 1.0, "bristle_stiffness": 4e5, "bristle_damping": 80.0}
    m = ts.simulate([ts.body(**hard)], drive, RATE)
    x, f = m.rows("x")[:, 0], m.rows("friction")[:, 0]
    before, after = slice(50, 970), slice(1250, 1500)
    assert np.abs(f[before] - ramp[before]).max() < 3e-3
    assert x[900] < 8e-6  # below an encoder step
    np.testing.assert_allclose(f[after], 1.0, rtol=1e-3)
    assert x[-1] > 0.005


@pytest.mark.parametrize("delay", [0.0, 0.0013, 0.004])
def test_delay(delay: float) -> None:
    drive = driven(500)
    m = ts.simulate([ts.body(delay=delay)], drive, RATE, 50)
    rows = (np.arange(len(m["x"])) / 5e3 - delay) * RATE + 1e-6
    want = np.where(rows >= 0, drive.feedforward[np.maximum(rows, 0).astype(int), 0], 0.0)
    np.testing.assert_allclose(m["acting"][:, 0], want, atol=1e-12)


def test_lag_and_hold() -> None:
    drive = ts.Drive.zero(100)
    drive.feedforward[10:, 0] = 2.0
    m = ts.simulate([ts.body(lag=0.006)], drive, RATE, 50)
    t = np.arange(len(m["x"])) / 5e3 - 0.010
    want = np.where(t > 0, 2.0 * (1 - np.exp(-np.maximum(t, 0) / 0.006)), 0.0)
    np.testing.assert_allclose(m["acting"][:, 0], want, atol=1e-10)
    held = ts.simulate([ts.body()], driven(50), RATE, 50)
    np.testing.assert_array_equal(held["acting"].reshape(50, 5), np.repeat(held.command, 5, axis=1))


def test_encoder_within_half_a_step() -> None:
    step = 8e-6
    m = closed_loop(50, step, grid_offset=3e-6)
    error = m.encoder - (m.rows("x") - 3e-6)
    assert np.abs(error).max() <= 0.5 * step * (1 + 1e-9)
    grid = m.encoder / step
    np.testing.assert_allclose(grid, np.round(grid), atol=1e-9)


def test_asymmetric_level_and_saturation() -> None:
    drive = ts.Drive.zero(400)
    drive.feedforward[:200, 0], drive.feedforward[200:, 0] = 5.0, -9.0
    p = ts.body(level=0.5, half_difference=0.2, bristle_stiffness=1e5, limit=6.0)
    m = ts.simulate([p], drive, RATE)
    assert m.rows("friction")[150, 0] == pytest.approx(0.7)
    assert m.rows("friction")[399, 0] == pytest.approx(-0.3)
    assert m["acting"].min() == -6.0


def test_triangle_average_is_what_a_second_difference_sees() -> None:
    """m * second difference = average force with triangular weight, exactly for a held force."""
    drive = driven(300)
    drive.direct[:] = 0.0
    m = ts.simulate([ts.body(inertia=0.3)], drive, RATE, 50)
    second = np.diff(m.rows("x")[:, 0], 2) * RATE**2 * 0.3
    average = triangle(m["acting"][:, 0], m.sub)[1:-1]
    np.testing.assert_allclose(average, second, atol=1e-7)


def test_lowpass_has_no_phase_and_half_power_squared_at_the_corner() -> None:
    t = np.arange(8000) / RATE
    y = lowpass(np.sin(2 * np.pi * 60 * t), 60.0, RATE)
    np.testing.assert_allclose(
        y[1000:-1000], 0.5 * np.sin(2 * np.pi * 60 * t)[1000:-1000], atol=1e-3
    )


@pytest.mark.parametrize(
    ("level", "effects", "kind"),
    [
        ("null", None, "device"),
        ("clear", ["stribeck"], "device"),
        pytest.param("null", None, "teleoperator", marks=pytest.mark.slow),
    ],
)
def test_case_meets_its_level(
    tmp_path: Path, level: str, effects: list[str] | None, kind: str
) -> None:
    case = make_case(np.random.default_rng(8), level, effects, kind)
    write_case(case, tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())
    assert {p.name for p in tmp_path.iterdir()} == {
        "experiment.toml", "fit.csv.gz", "check.csv.gz", "truth.json",
    }  # fmt: skip
    if level == "null":
        assert truth["effects"] == [] and 0.7 < truth["ratio"] < 1.3
    else:
        assert truth["ratio"] >= 4
        assert set(truth["effects"][0]["parameters"]) == {"extra_static_level", "stribeck_velocity"}
    assert 0.7 < truth["check_error_true"] / truth["noise_floor"] < 1.4
