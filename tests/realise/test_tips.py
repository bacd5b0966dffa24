"""A compliant transmission is two moving bodies, whatever simulates it."""

import control
import numpy as np
import pytest
from devices import body

from teleopdesign.blocks import Body
from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import SIGNALS, load_effect
from teleopdesign.frequency import bode, transfer_function
from teleopdesign.frequency.matrix_response import matrix_response
from teleopdesign.passivity import hand_port
from teleopdesign.realise.tips import with_tips
from teleopdesign.simulate import simulate, sine

M, TIP, K, C, B = 0.3, 0.1, 3e3, 1.5, 2.0
COMPLIANT = {
    "viscous__damping": B,
    "transmission_compliance__tip_inertia": TIP,
    "transmission_compliance__stiffness": K,
    "transmission_compliance__damping": C,
}
HAND = body(0.2, viscous__damping=3.0, spring__stiffness=200.0)


def two_masses():
    """Actuator 0.2 kg with a damper, tip and hand 0.3 kg: written down by hand; force to both."""
    m, t = M - TIP, TIP + 0.2
    a = [
        [0, 1, 0, 0],
        [-K / m, -(C + B) / m, K / m, C / m],
        [0, 0, 0, 1],
        [K / t, C / t, -(K + 200) / t, -(C + 3) / t],
    ]
    return control.ss(a, [[0], [1 / m], [0], [0]], [[1, 0, 0, 0], [0, 0, 1, 0]], [[0], [0]])


@pytest.mark.parametrize("computer", ["continuous", "sampled"])
def test_actuator_and_tip_move_as_two_masses_on_a_spring(computer):
    """Step of force, held: the same sampled or not. Order four at 0.1 ms and 25 Hz: 1e-7."""
    diagram = haptic_interface(body(M, **COMPLIANT), hand=HAND)
    mode = {} if computer == "sampled" else {"computer": "continuous"}
    simulation = simulate(diagram, duration=0.3, inputs={"R_D": 1.0}, jit=False, **mode)
    _, expected = control.step_response(two_masses(), simulation["time"].values)
    for name, row in zip(("L", "L_tip"), expected[:, 0], strict=True):
        assert np.abs(simulation[name].values - row).max() < 1e-7 * np.abs(row).max()


def test_a_hand_leads_the_tip_and_feels_both_bodies():
    """Slow against the resonance (13 Hz): the whole inertia and the actuator's friction."""
    diagram = haptic_interface(body(M, **COMPLIANT))
    motion = sine(amplitude=0.01, frequency=0.5)
    simulation = simulate(diagram, duration=4.0, motion={"L_tip": motion}, jit=False, step=1e-3)
    time = simulation["time"].values
    expected = M * motion.acceleration(time) + B * motion.velocity(time)
    late = time > 2.0
    # the actuator is late by B omega/K = 2.1e-3, and 20 Hz on the spring: (0.5/20)^2 = 6e-4
    assert np.abs(simulation["R_V"].values - expected)[late].max() < 3e-3 * np.abs(expected).max()


def test_coulomb_friction_at_each_end():
    """0.25 N on the tip, which holds 0.2 N: what passes through the spring is held behind it."""
    diagram = haptic_interface(body(M, coulomb__level=0.3, **COMPLIANT))
    both = with_tips(diagram).with_block("Z_M_tip", body(TIP, coulomb__level=0.2))
    pushed = {"R_V": lambda t: 0.25 * np.clip(t / 0.1, 0, 1)}
    simulation = simulate(both, duration=0.5, inputs=pushed, jit=False)
    last = {n: float(x[-1]) for n, x in simulation.data.items()}
    passed = -last["Z_M_transmission"]
    assert 0.05 < passed < 0.25
    # at rest but for what is left of the oscillation after 0.4 s
    assert last["Z_M_friction"] == pytest.approx(passed, abs=2e-3)
    assert last["Z_M_tip_friction"] == pytest.approx(0.25 - passed, abs=2e-3)
    assert abs(last["L"]) < 1e-5 < last["L_tip"]  # 10 um: the give of its friction


def test_friction_of_the_tip_is_that_of_the_tip_as_a_separate_body():
    held = haptic_interface(body(M, tip_friction__level=0.2, **COMPLIANT))
    apart = with_tips(haptic_interface(body(M, **COMPLIANT)))
    apart = apart.with_block("Z_M_tip", body(TIP, coulomb__level=0.2))
    one, other = (
        simulate(d, duration=0.05, inputs={"R_D": 1.0}, jit=False)["L_tip"].values
        for d in (held, apart)
    )
    assert one.max() > 1e-4
    np.testing.assert_allclose(one, other, rtol=0, atol=1e-12 * one.max())


def test_through_a_gap_two_bodies_exchange_momentum_and_keep_energy():
    """No damping: the actuator's side meets the resting tip behind half a gap, and passes on."""
    gap, stiffness, speed = 2e-3, 2e4, 0.1
    values = {"tip_inertia": TIP, "stiffness": stiffness, "damping": 0.0, "gap": gap}
    lost = body(M, **{f"backlash__{n}": v for n, v in values.items()})
    start = {"L_velocity": speed}
    run = dict(duration=0.1, initial=start, computer="continuous", step=2e-5)
    simulation = simulate(haptic_interface(lost), **run, jit=False)
    here, there = (simulation[f"{n}_velocity"].values for n in ("L", "L_tip"))
    twist = simulation["L_twist"].values
    free = np.abs(twist) <= gap / 2
    m = M - TIP
    before = simulation["time"].values < 0.009  # half the gap takes 10 ms
    assert np.all(there[before] == 0.0) and free[-1]
    # rounding, and the kink of the force at the touch: order one in a step of 2e-5 s
    np.testing.assert_allclose(m * here + TIP * there, m * speed, rtol=1e-9)
    deep = np.maximum(np.abs(twist) - gap / 2, 0)
    energy = m * here**2 + TIP * there**2 + stiffness * deep**2
    np.testing.assert_allclose(energy, m * speed**2, rtol=2e-3)
    assert there.max() == pytest.approx(4 / 3 * speed, rel=1e-3)  # 0.2 kg on 0.1 kg


def impedance_at_the_tip(f):
    """R_V over L_tip: tip on a spring and damper that the actuator's side holds."""
    s = 2j * np.pi * f
    link, here = K + C * s, (M - TIP) * s**2 + B * s
    return TIP * s**2 + link * here / (link + here)


def test_all_linear_forms_see_the_hand_at_the_tip():
    f = np.array([0.5, 13.0, 40.0])
    diagram = haptic_interface(body(M, **COMPLIANT))
    expected = impedance_at_the_tip(f)
    zhat = {"output": "E", "input": "L", "given": "L"}
    np.testing.assert_allclose(bode(diagram, frequency=f, **zhat).values(), expected, rtol=1e-9)
    system, left_out = transfer_function(diagram, **zhat)
    np.testing.assert_allclose(system(2j * np.pi * f), expected, rtol=1e-9)
    response = matrix_response(diagram, ("E", "L"), ("L",), f, given=("L",))
    np.testing.assert_allclose(response.data.values[:, 0, 0], expected, rtol=1e-9)
    np.testing.assert_allclose(response.data.values[:, 1, 0], 1.0)
    velocity, _ = hand_port(diagram)
    s = 2j * np.pi * f
    np.testing.assert_allclose(velocity(s) * s, expected, rtol=1e-9)
    assert left_out == response.left_out == ()


SOURCE = '''"""A cable of a user's own, twice as hard where it is pulled."""

from sympy import Piecewise

from teleopdesign.effects import Parameter, make_structure


def coupling(now, p):
    pulled = Piecewise((2, now.stretch > 0), (1, True))
    return p.stiffness * pulled * now.stretch + p.damping * now.stretch_rate


EFFECT = make_structure(
    coupling=coupling,
    parameters={
        "tip_inertia": Parameter("inertia", "of the tip"),
        "stiffness": Parameter("stiffness", "of the cable"),
        "damping": Parameter("damping", "of the cable"),
    },
    following=1.0,
)
'''
VALUES = {"tip_inertia": TIP, "stiffness": K, "damping": C}


def written(folder, text):
    file = folder / "own_cable.py"
    file.write_text(text)
    return file


def test_one_coupling_is_the_law_of_one_body_and_the_joint_of_two(tmp_path):
    """The rates of the hidden tip are those of two bodies, whatever the coupling."""
    effect = load_effect(written(tmp_path, SOURCE))
    made = Body("prismatic", {"inertia": M}).with_effect(effect, VALUES)
    run = simulate(
        haptic_interface(made),
        duration=0.05,
        inputs={"R_D": lambda t: 3 * np.sin(200 * t)},
        jit=False,
    )
    here = {
        SIGNALS["position"]: "L",
        SIGNALS["velocity"]: "L_velocity",
        **dict(zip(effect.state_symbols().values(), ("L_tip", "L_tip_velocity"), strict=True)),
    }
    acceleration = np.gradient(run["L_velocity"].values, run["time"].values)
    hidden = made.numbers() | {SIGNALS["interaction_force"]: 0.0}
    stretch = run["L"].values - run["L_tip"].values
    assert stretch.max() > 2e-4 and stretch.min() < -2e-4  # pulled and pushed
    for k in range(5, 45, 4):
        at = hidden | {s: float(run[n][k]) for s, n in here.items()}
        at |= {SIGNALS["acceleration"]: float(acceleration[k])}
        joint = float(run["Z_M_transmission"][k])
        tip = float(effect.rates()["tip_velocity"].subs(at))
        assert TIP * tip == pytest.approx(joint, rel=1e-9, abs=1e-12)
        value = float(effect.expression().subs(at))
        assert value + TIP * at[SIGNALS["acceleration"]] == pytest.approx(joint, abs=1e-9)
