"""The compiled kernel: accuracy, the guard of its step, sampling, and what it refuses."""

import os
from types import SimpleNamespace

import numpy as np
import pytest
from devices import CANCELLATION, FEEDBACK, LUGRE, body
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface, world_haptics_2005
from teleopdesign.realise.compiled import cache_folder
from teleopdesign.realise.equations import Layout
from teleopdesign.realise.kernel import (
    FINER,
    RELOAD,
    Timing,
    execute,
    fastest_rate,
    fastest_rates,
    refine_factor,
    round_up_steps,
    worst_reload,
)
from teleopdesign.simulate import Sampling, prepare, simulate, sine

REFERENCE = sine(amplitude=0.01, frequency=1.5)


def hand_written(t, y):
    """The fixture `hybrid` in continuous time, written down by hand: an independent statement."""
    x, v, z, w, memory = y
    level = 0.5 + 0.1 * np.exp(-((v / 0.005) ** 2))
    error = 0.01 * np.sin(3 * np.pi * t) - x
    desired = 2e4 * (error + memory)
    acting = desired + w + 0.5 * v / (0.015 + abs(v))
    acceleration = (acting - 1e5 * z - 0.1 * v) / 0.65
    force_error = desired - 0.5 * acceleration
    return [
        v,
        acceleration,
        v - 1e5 / level * abs(v) * z,
        2 * np.pi * 20 * (0.4 / (0.08 + abs(v)) * force_error - w),
        -98 * np.pi * error - 100 * np.pi * memory,
    ]


@pytest.fixture(scope="module")
def radau():
    """Two reversals of the friction, one of the reference: 0.25 s, started at rest."""
    time = 1e-3 * np.arange(251)
    start = [0.0] * 5
    return solve_ivp(hand_written, (0, 0.25), start, "Radau", time, rtol=1e-10, atol=1e-13).y


def test_force_is_within_1e_4_and_position_within_1e_6_of_radau(hybrid, radau):
    """Default step; the bounds are those asked of a kernel for figures of a paper."""
    simulation = simulate(
        hybrid, duration=0.25, inputs={"L_D": REFERENCE.position}, computer="continuous"
    )
    force = simulation["Z_M_friction"].values
    assert simulation.data.attrs["step_s"] == pytest.approx(1e-4)
    assert np.abs(force - 1e5 * radau[2]).max() < 1e-4 * np.abs(force).max()
    assert np.abs(simulation["L"].values - radau[0]).max() < 1e-6 * np.abs(radau[0]).max()


@pytest.mark.parametrize("step", [1e-3, 5e-4])
def test_a_step_too_long_for_the_bristle_is_refined(hybrid, radau, step):
    """At 1 ms the unguarded force is wrong by 5e-3; refined it keeps its bound."""
    simulation = simulate(
        hybrid, duration=0.25, inputs={"L_D": REFERENCE.position}, computer="continuous", step=step
    )
    assert simulation.data.attrs["step_s"] < 3e-4
    error = np.abs(simulation["Z_M_friction"].values - 1e5 * radau[2]).max()
    assert error < 2e-4 * 1e5 * np.abs(radau[2]).max()  # 10 steps a reload: 1e-4 at 14 steps


def test_or_it_is_refused_with_the_step_to_use(hybrid):
    with pytest.raises(ModelError, match=r"step 1 ms is .* steps .*: use .* ms or less") as e:
        simulate(
            hybrid,
            duration=0.25,
            inputs={"L_D": REFERENCE.position},
            computer="continuous",
            step=1e-3,
            long_step="refuse",
        )
    assert "\n" not in str(e.value)


def test_a_stiff_bristle_on_a_light_body_is_refused_by_its_oscillation(hybrid):
    stiff = hybrid.with_values({"Z_M.presliding.stiffness": 4e7})
    with pytest.raises(ModelError, match="steps per period of"):
        simulate(stiff, duration=0.01, computer="continuous", long_step="refuse", step=5e-4)


def test_the_error_falls_with_the_step(hybrid, radau):
    """At kinks of abs(v) in the laws the order is below four; between 1e-4 and 2e-5 s above one."""
    made = prepare(hybrid, duration=0.25, inputs={"L_D": REFERENCE.position}, computer="continuous")
    column = made.program.layout.columns.index("Z_M_friction")
    errors = []
    for inner in (10, 50):
        rows, _ = made.run(made.timing(inner))
        errors.append(np.abs(rows[:, column] - 1e5 * radau[2]).max())
    assert errors[1] < errors[0] / 5


def test_the_error_of_the_step_can_be_asked_for(hybrid, radau):
    """Half the step has a third to a quarter of the error: the estimate is of its size."""
    simulation = simulate(
        hybrid,
        duration=0.25,
        inputs={"L_D": REFERENCE.position},
        computer="continuous",
        estimate_error=True,
    )
    force = 1e5 * radau[2]
    error = np.abs(simulation["Z_M_friction"].values - force).max() / np.abs(force).max()
    assert 0.3 * error < simulation["Z_M_friction"].attrs["step_error"] < 2 * error


def test_values_are_arguments_of_one_kernel(hybrid):
    made = prepare(hybrid, duration=0.1)
    other = prepare(hybrid.with_values({"H.velocity_schedule.gain": 2.0}), duration=0.1)
    assert made.program.loop is other.program.loop


def test_compiled_and_plain_code_give_the_same_numbers(hybrid):
    arguments = dict(duration=0.02, inputs={"L_D": REFERENCE.position}, computer="continuous")
    fast, plain = (simulate(hybrid, jit=jit, **arguments).data for jit in (True, False))
    for name in fast:
        # rounding only: the compiler may contract and reorder
        np.testing.assert_allclose(fast[name], plain[name], rtol=1e-9, atol=1e-12)


def moved(**sampling):
    """Commanded cancellation for a prescribed motion."""
    diagram = haptic_interface(body(0.1), cancellation=CANCELLATION)
    return simulate(
        diagram,
        duration=0.1,
        motion={"L": REFERENCE},
        computer=Sampling(**sampling),
        every_step=True,
        jit=False,
    )


def test_the_command_is_held_and_acts_after_the_delay():
    at_once, late = moved(), moved(delay=3e-4)
    force = at_once["R_M"] + 0.1 * at_once["L_acceleration"]  # = acting force
    delayed = late["R_M"] + 0.1 * late["L_acceleration"]
    inside = np.arange(len(force)) % 10
    kept = inside[:-3] != 0  # rows at samples still show the force before
    np.testing.assert_allclose(delayed[3:][kept], force[:-3][kept], atol=1e-12)
    changes = np.abs(np.diff(force)) > 1e-9
    assert set(inside[:-1][changes]) == {0}


def test_velocity_is_the_filtered_difference_of_encoder_steps():
    step, period = 1e-4, 1e-3
    simulation = moved(encoder_step=step, velocity_bandwidth=50.0)
    x = np.floor(simulation["L"].values[::10] / step + 0.5) * step
    keep, v, forces = np.exp(-2 * np.pi * 50 * period), 3 * np.pi * 0.01, []
    for n in range(len(x)):
        v = v if n == 0 else keep * v + (1 - keep) * (x[n] - x[n - 1]) / period
        forces.append(0.5 * v / (0.015 + abs(v)))
    np.testing.assert_allclose(simulation["R_MBC"].values[::10], forces, atol=1e-12)


def test_a_delay_that_is_no_whole_number_of_steps_is_refused():
    with pytest.raises(ModelError, match="no whole number of steps"):
        moved(delay=1.37e-4)


def test_force_feedback_may_be_analog_beside_a_sampled_cancellation():
    diagram = world_haptics_2005()
    simulation = simulate(
        diagram, duration=0.02, motion={"L": REFERENCE}, every_step=True, jit=False
    )
    changes = np.abs(np.diff(simulation["R_FF"].values)) > 0
    held = np.abs(np.diff(simulation["R_MBC"].values)) > 0
    assert changes.sum() > 150 and held.sum() <= 20


def test_actuation_delay_and_lag_act_between_command_and_body():
    """A step of force on a free mass: (t - tau)^2/2m after the delay; a lag's exact response."""
    step = {"R_D": 1.0}
    late = simulate(
        haptic_interface(body(2.0, actuation_delay__delay=5e-3)),
        duration=0.05,
        inputs=step,
        jit=False,
    )
    t = np.clip(late["L"]["time"].values - 5e-3, 0, None)
    np.testing.assert_allclose(late["L"].values, t**2 / 4, atol=1e-12)
    lag = 4e-3
    soft = simulate(
        haptic_interface(body(2.0, actuator_lag__time_constant=lag)),
        duration=0.05,
        inputs=step,
        jit=False,
    )
    t = soft["L"]["time"].values
    # the exponential step is exact in the lag itself, of order four in the motion: (h/tau)^4 = 4e-7
    expected = (t - lag * (1 - np.exp(-t / lag))) / 2
    np.testing.assert_allclose(soft["L_velocity"].values, expected, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"inputs": {"R_VV": 1.0}}, 'did you mean "R_V"'),
        ({"motion": {"X": REFERENCE}}, '"X" is no motion, has L'),
        ({"initial": {"L_velocty": 1.0}}, 'did you mean "L_velocity"'),
        ({"inputs": {"R_V": np.zeros(3)}}, "has 3 samples, expected"),
    ],
)
def test_what_cannot_be_simulated_is_reported_in_one_line(arguments, words):
    with pytest.raises(ModelError) as caught:
        simulate(haptic_interface(body(0.1)), duration=0.01, jit=False, **arguments)
    assert words in str(caught.value) and "\n" not in str(caught.value)


def test_a_block_known_by_name_only_has_no_simulation():
    with pytest.raises(ModelError, match="Z_M is known by its name only"):
        simulate(haptic_interface(), duration=0.1)


def test_an_unstable_loop_is_no_result():
    wild = controller("lead", {"gain": 1e8, "zero": 1.0, "pole": 2.0})
    diagram = haptic_interface(body(0.1), position_loop=wild)
    with pytest.raises(ModelError, match="grow beyond all bounds"):
        simulate(diagram, duration=1.0, inputs={"L_D": 1.0}, jit=False, step=1e-3)


def test_fast_sliding_does_not_overflow_the_stribeck_level():
    """At 60 times the Stribeck velocity exp(-(v/v_S)^2) is 0, and was once written 1/inf."""
    moved = sine(amplitude=0.01, frequency=5.0)
    simulation = simulate(
        haptic_interface(body(**LUGRE)), duration=0.1, motion={"L": moved}, jit=False
    )
    assert np.abs(simulation["Z_M_friction"]).max() < 0.56


def test_results_are_labelled_and_can_be_kept(hybrid, tmp_path):
    simulation = simulate(hybrid, duration=0.05, inputs={"L_D": REFERENCE.position}, jit=False)
    assert simulation["L"].attrs["units"] == "m" and simulation["R_M"].attrs["units"] == "N"
    assert (
        simulation["L_E"].attrs["units"] == "m" and simulation["L_velocity"].attrs["units"] == "m/s"
    )
    assert "haptic interface" in repr(simulation) and "R_MBC" in repr(simulation)
    simulation.to_netcdf(tmp_path / "run.nc")
    assert (tmp_path / "run.nc").stat().st_size > 1000
    assert len(simulation.plot("L", "R_M").axes) == 2


def test_feedback_needs_its_measured_signal(hybrid):
    from dataclasses import replace

    blind = replace(hybrid, measured=("L",))
    with pytest.raises(ModelError, match='uses "R_H" of Z_H, which is not measured'):
        simulate(blind, duration=0.01)


def test_an_outside_signal_may_be_named_among_those_measured(hybrid):
    from dataclasses import replace

    def run(diagram):
        desired = 0.01 * np.sin(np.arange(51) / 5.0)
        return simulate(diagram, duration=0.05, inputs={"L_D": desired}, jit=False)["L"].values

    named = replace(hybrid, measured=(*hybrid.measured, "L_D"))
    assert np.array_equal(run(named), run(hybrid)) and np.ptp(run(named)) > 0


def test_dahl_cancellation_is_sampled_exactly_in_a_closed_loop():
    """The sampled bristle stays within its level also when positions jump by encoder steps."""
    dahl = controller("dahl", {"level": 0.4, "stiffness": 2e4})
    diagram = haptic_interface(
        body(**LUGRE), hand=body(0.5), cancellation=dahl, force_feedback=FEEDBACK
    )
    simulation = simulate(
        diagram,
        duration=0.2,
        inputs={"R_D": lambda t: 2 * np.sin(2 * np.pi * 5 * t)},
        computer=Sampling(encoder_step=2e-5, delay=1e-3),
        jit=False,
    )
    assert 0.3 < np.abs(simulation["R_MBC"]).max() <= 0.4 * (1 + 1e-12)


def test_a_saturated_actuator_acts_behind_the_command():
    """Commanded 2 N, limited to 0.5 N, on 1 kg: 0.5 m/s^2, sampled or not."""
    made = haptic_interface(body(1.0, actuator_saturation__limit=0.5))
    for computer in ("continuous", Sampling()):
        simulation = simulate(
            made, duration=0.02, inputs={"R_D": 2.0}, computer=computer, jit=False, step=1e-3
        )
        np.testing.assert_allclose(simulation["L_acceleration"].values[1:], 0.5, rtol=1e-12)
        np.testing.assert_allclose(simulation["R_A"].values, 2.0)


def test_a_simulation_that_would_fill_the_memory_is_refused():
    with pytest.raises(ModelError, match=r"1e\+09 steps of 0.0001 s need .* GB: use a longer"):
        simulate(haptic_interface(body(0.1)), duration=1e5, inputs={"R_D": 0.0}, jit=False)


@pytest.mark.skipif(os.name != "posix", reason="homes of POSIX")
def test_a_home_that_does_not_exist_is_not_made(tmp_path, monkeypatch):
    for name in ("TELEOPDESIGN_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    home = tmp_path / "nobody"
    monkeypatch.setenv("HOME", str(home))
    folder = cache_folder()
    assert folder is not None and folder.is_dir() and not home.exists()
    home.mkdir()
    assert cache_folder().is_relative_to(home)


@given(times=st.integers(1, 12), over=st.floats(1.0, 1.9), power=st.sampled_from([1.0, 2.0, 4.0]))
def test_a_step_is_made_shorter_until_its_measure_is_surely_below_the_bound(times, over, power):
    bound = 0.7
    measure = bound * (times * over) ** power
    factor = refine_factor(measure, bound, power)
    assert isinstance(factor, int)
    assert measure / factor**power < bound
    # and by no more than one part than that asks for
    assert factor <= times * over * 1.0001 + 1


def test_the_fastest_rate_of_each_lane_names_its_state():
    jacobian = np.array(
        [
            [[-1.0, 0.0], [0.0, -7.0]],
            [[0.0, 30.0], [-30.0, 0.0]],
            [[np.inf, 0.0], [0.0, 1.0]],
            [[5.0, 0.0], [0.0, 2.0]],
        ]
    )
    rates, states = fastest_rates(jacobian)
    assert rates.tolist() == pytest.approx([7.0, 30.0, 0.0, 5.0])
    assert (states[0], states[3]) == (1, 0)


@pytest.mark.parametrize("reloads", [(7.0, 3.0), (3.0, 7.0), (0.0, 0.0), ()])
def test_the_measure_of_a_run_is_that_of_its_worst_bristle(reloads):
    """The loop is a stand-in that writes a measure for each bristle, and a row of zeros behind."""
    names = tuple(f"z{i}" for i in range(len(reloads)))
    layout = Layout(names, (), (), (), (), (), ("mass",), ("x",), names)
    places = {"PARAMETERS": 0, "COLUMNS": 1, "WORST": 4, "ROWS": 8}

    def run(*arguments):
        memory = next(a for a in arguments if isinstance(a, np.ndarray) and a.shape == (8,))
        memory[2:8] = 99.0
        memory[4 : 4 + len(reloads)] = reloads

    made = SimpleNamespace(layout=layout, functions=places, loop=SimpleNamespace(run=run))
    timing = Timing(1e-4, 10, 5, 0, (), 0.0, 0.0)
    none = np.zeros((0, 1))
    rows = {False: 6, True: 51}
    for every_step, count in rows.items():
        out, worst = execute(
            made, {"mass": 2.0}, timing, inputs=none, sampled=none, start={}, every_step=every_step
        )
        assert worst == max(reloads, default=0.0) and out.shape == (count, 1)


def test_what_has_no_state_has_no_fastest_rate():
    layout = Layout((), (), (), (), (), (), (), (), ())
    assert fastest_rate(SimpleNamespace(layout=layout), {}) == (0.0, "")


@given(needed=st.integers(1, 4000), least=st.integers(1, 20))
def test_a_grid_has_as_many_steps_as_needed_or_the_next_number_that_is_allowed(needed, least):
    count = round_up_steps(needed, least)
    allowed = [least * f for f in FINER]
    if needed > allowed[-1]:
        assert count is None
    else:
        assert count in allowed and count >= needed
        assert not any(needed <= a < count for a in allowed)


@given(least=st.integers(1, 50), share=st.sampled_from([0.999, 1.001]))
def test_a_run_ends_where_not_even_the_finest_grid_would_do(least, share):
    """The measure falls with the square of the step."""
    limit = worst_reload(least, least)
    factor = refine_factor(share * limit, RELOAD, 2.0)
    assert factor == FINER[-1] + (share > 1.0)
    # seen from a grid that is twice as fine, a quarter of it is left
    assert worst_reload(2 * least, least) == pytest.approx(limit / 4.0)
