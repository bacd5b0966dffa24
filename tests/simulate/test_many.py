"""Many simulations at once: the same numbers as one by one, and what fails stays by itself."""

import numpy as np
import pytest
from devices import body, coupled
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.diagrams import haptic_interface
from teleopdesign.simulate import Sampling, simulate, simulate_many

#: two loops that differ by rounding in one exp: 1e-9 of the largest value, as golden/ allows
ROUNDING = 1e-9


def push(t):
    return 2.0 * np.sin(30.0 * t)


RUN = dict(duration=0.1, inputs={"F_u": push})
NAMES = ("X_m", "X_s_velocity", "F_m", "F_P", "Z_m_presliding_bristle", "U_m")
FIGURES = {
    "last": ("X_e", "final"),
    "least": ("X_e", "minimum"),
    "most": ("X_e", "maximum"),
    "size": ("F_P", "peak"),
    "middle": ("F_m", "mean"),
    "rms": ("F_P", "rms"),
    "drawn": (("F_m", "X_m"), "energy"),
}


def by_hand(simulation, after=0.0):
    """The figures from the rows of one simulation."""
    kept = simulation.data["time"].values >= after - 1e-9
    t = simulation.data["time"].values[kept]
    x, p, f, v = (simulation[n].values[kept] for n in ("X_e", "F_P", "F_m", "X_m_velocity"))
    return {
        "last": x[-1],
        "least": x.min(),
        "most": x.max(),
        "size": np.abs(p).max(),
        "middle": f.mean(),
        "rms": np.sqrt(np.mean(p**2)),
        "drawn": np.trapezoid(f * v, t),
    }


def assert_same(data, case, simulation, after=0.0):
    for name in NAMES:
        one, many = simulation[name].values, data[name].values[case]
        assert np.abs(one - many).max() <= ROUNDING * np.abs(one).max(), name
    for name, value in by_hand(simulation, after).items():
        size = max(
            abs(value), 1e-3 * float(np.abs(simulation["F_P"]).max()) * (name != "drawn"), 1e-9
        )
        assert abs(float(data[name][case]) - value) <= 1e-8 * size, name
    assert float(data["step"][case]) == simulation.data.attrs["step_s"]
    assert data["reason"].values[case] == ""


@given(
    st.lists(
        st.tuples(
            st.floats(0.05, 1.0) | st.just(0.0), st.floats(1e3, 1e5), st.floats(0.1, 1.0),
            st.floats(0.0, 0.5),
        ),
        min_size=1,
        max_size=20,
    )
)  # fmt: skip
@settings(max_examples=4, suppress_health_check=[HealthCheck.too_slow])
def test_each_case_has_the_numbers_of_a_simulation_alone(rows):
    """Friction that is absent, steps that are refined case by case, any number of lanes."""
    level, stiffness, inertia, cancelled = map(np.array, zip(*rows, strict=True))
    values = {
        "Z_m.coulomb.level": level,
        "Z_m.presliding.stiffness": stiffness,
        "Z_m.inertia": inertia,
        "C_m.dahl.level": cancelled + 1e-3,
    }
    diagram = coupled()
    many = simulate_many(diagram, values, **RUN, keep=NAMES, reduce=FIGURES, after=0.02)
    for case in range(len(rows)):
        at = {n: float(v[case]) for n, v in values.items()}
        simulation = simulate(diagram.with_values(at), **RUN)
        names = [n for n in NAMES if n in simulation.data]  # without friction there is no bristle
        if len(names) == len(NAMES):
            assert_same(many, case, simulation, after=0.02)
        else:
            assert np.isnan(many["Z_m_presliding_bristle"][case]).all()
            assert many["F_P"].values[case] == pytest.approx(simulation["F_P"].values, rel=1e-9)


@pytest.mark.parametrize("computer", ["continuous", Sampling(delay=3e-4, encoder_step=1e-5)])
def test_sampled_and_continuous_loops_are_the_same_too(computer):
    values = {"P.spring_damper.stiffness": np.linspace(100.0, 400.0, 19)}
    run = RUN | {"computer": computer}
    many = simulate_many(coupled(), values, **run, keep=NAMES, reduce=FIGURES)
    for case in (0, 7, 18):
        at = {n: float(v[case]) for n, v in values.items()}
        assert_same(many, case, simulate(coupled().with_values(at), **run, jit=False))


def test_ideal_friction_gets_its_give_in_every_case():
    """What is simulated follows from the level: the stiffness of a bristle that nobody gave."""
    diagram = coupled(coulomb__level=0.5)
    values = {"Z_m.coulomb.level": [0.1, 0.2, 0.4, 0.2]}
    many = simulate_many(diagram, values, **RUN, keep=["X_m"])["X_m"]
    for case, level in enumerate(values["Z_m.coulomb.level"]):
        one = simulate(diagram.with_values({"Z_m.coulomb.level": level}), **RUN)["X_m"].values
        assert np.abs(one - many.values[case]).max() <= ROUNDING * np.abs(one).max()
    assert np.array_equal(many[1], many[3]) and np.ptp(many.values[:, -1]) > 0


def test_delays_are_grouped_and_one_that_no_step_divides_is_reported():
    diagram = haptic_interface(body(2.0, actuation_delay__delay=5e-3))
    delays = [5e-3, 2e-3, 1.23e-4 / 3, 5e-3]
    many = simulate_many(
        diagram,
        {"Z_M.actuation_delay.delay": delays},
        duration=0.05,
        inputs={"R_D": 1.0},
        reduce={"end": ("L", "final")},
    )
    expected = [0.045**2 / 4, 0.048**2 / 4, np.nan, 0.045**2 / 4]
    np.testing.assert_allclose(many["end"], expected, rtol=1e-10)
    assert "delay" in str(many["reason"].values[2]) and list(many["reason"].values[:2]) == ["", ""]


def test_a_case_that_fails_is_nan_with_its_reason_and_kills_no_other():
    """Out of bounds, unstable, and two good ones: by the words that one simulation raises."""
    stiffness = np.array([200.0, -5e8, 300.0, 1e6])
    inertia = np.array([0.15, 0.15, -1.0, 0.15])
    diagram = coupled()
    values = {"P.spring_damper.stiffness": stiffness, "Z_m.inertia": inertia}
    run = dict(duration=0.5, inputs={"F_u": push})
    many = simulate_many(diagram, values, **run, reduce={"e": ("X_e", "rms")})
    for case in range(4):
        at = {n: float(v[case]) for n, v in values.items()}
        try:
            simulation = simulate(diagram.with_values(at), **run)
        except ModelError as error:
            assert str(many["reason"].values[case]) == str(error)
            assert np.isnan(many["e"].values[case]) and np.isnan(many["step"].values[case])
        else:
            rms = float(np.sqrt(np.mean(simulation["X_e"].values ** 2)))
            assert many["e"].values[case] == pytest.approx(rms, rel=1e-8)
    failed = [bool(reason) for reason in many["reason"].values]
    assert failed[2] and not failed[0] and "\n" not in "".join(many["reason"].values.tolist())


def test_what_comes_back_by_default_is_the_rms_of_every_signal():
    many = td.simulate_many(coupled(), {"Z_m.inertia": [0.1, 0.2]}, **RUN)
    simulation = simulate(coupled().with_values({"Z_m.inertia": 0.2}), **RUN)
    assert {str(n) for n in many} == {f"{n}_rms" for n in simulation.data}
    assert many.sizes == {"case": 2} and many["F_m_rms"].attrs["units"] == "N"
    assert many["Z_m.inertia"].values.tolist() == [0.1, 0.2]
    for name, x in simulation.data.items():
        rms = float(np.sqrt(np.mean(x.values**2)))
        assert many[f"{name}_rms"].values[1] == pytest.approx(rms, rel=1e-8, abs=1e-15)


def test_threads_share_nothing_that_is_written(monkeypatch):
    values = {"P.spring_damper.stiffness": np.linspace(100.0, 400.0, 70)}
    results = []
    for threads in ("1", "4"):
        monkeypatch.setenv("NUMBA_NUM_THREADS", threads)
        results.append(simulate_many(coupled(), values, **RUN, keep=["X_m"]))
    assert results[0].identical(results[1])
