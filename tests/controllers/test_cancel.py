"""The law "cancel": the force of effects by the laws of their own files."""

import math
import pickle
import shutil
import subprocess
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp

import teleopdesign as td
from teleopdesign.blocks import compose_equation
from teleopdesign.controllers import ControlLaw, Stage, broken_declarations, why_not_cancelled
from teleopdesign.effects import EFFECTS, SIGNALS, Parameter, with_block_effects
from teleopdesign.realise.c_header import as_c_header

CANCELLED = [n for n in EFFECTS if not why_not_cancelled(EFFECTS[n])]
#: stands between the command and the level by its states: at a steady speed it changes nothing
STEADY = {"friction_memory", "presliding"}


def with_needs(name):
    """The effect and those that it needs, in the order in which a body can have them."""
    needed = [e for n in sorted(with_block_effects()[name].needs) for e in with_needs(n)]
    return [*needed, with_block_effects()[name]]


def values_of(effect):
    """A value within the bounds for each parameter that must be stated."""
    stated = {n: p for n, p in effect.parameters.items() if not p.optional}
    return {n: min(0.3 + 0.1 * i, p.upper / 2) for i, (n, p) in enumerate(stated.items())}


def each(name):
    """A curve of eight values takes seconds."""
    return pytest.param(name, marks=pytest.mark.slow if EFFECTS[name].free else ())


@pytest.mark.parametrize("name", [each(n) for n in CANCELLED if n not in STEADY])
def test_law_gives_the_force_that_the_effect_takes(name):
    effects = list(dict.fromkeys(with_needs(name)))
    law = td.cancel({e: values_of(e) for e in effects}, smoothing_velocity=1e-12)
    stage = law.stages[0]
    equation = compose_equation(tuple(effects))
    numbers = {e.symbols()[n]: v for e in effects for n, v in values_of(e).items()}
    numbers |= {e.symbols()[n]: 0.0 for e in effects for n, p in e.parameters.items() if p.optional}
    for x, v, command, time in ((0.3, 0.7, 0.4, 0.5), (-1.1, -0.2, -0.9, 2.0)):
        now = {"position": x, "velocity": v, "direction": math.copysign(1, v), "time": time}
        here = numbers | {SIGNALS[n]: value for n, value in now.items()}
        here |= {SIGNALS["acting_force"]: command, SIGNALS["acceleration"]: 0.0}
        here = {symbol: sp.Float(value) for symbol, value in here.items()}
        needed = float((equation.force + equation.friction).xreplace(here))
        read = {"input": x, "velocity": v, "speed": abs(v), "travel_rate": v, "time": time}
        now_read = SimpleNamespace(**read, command=command)
        output = float(stage.law.law(now_read, SimpleNamespace(**stage.values)))
        here[SIGNALS["command"]] = sp.Float(command + output)
        acting = equation.acting.xreplace(here)
        assert float(acting) == pytest.approx(command + needed, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("name", [n for n in EFFECTS if n not in CANCELLED])
def test_what_cannot_be_cancelled_is_refused_in_one_line_with_its_name(name):
    effects = list(dict.fromkeys(with_needs(name)))
    stated = {e: dict.fromkeys(e.parameters, 1.0) for e in effects}
    with pytest.raises(td.ModelError) as refused:
        td.cancel(stated, only=[name])
    assert name in str(refused.value) and "\n" not in str(refused.value)


def device():
    """A revolute joint with effects of place, load, time and speed."""
    body = td.Body("revolute", {"inertia": 0.001})
    stated = {
        "coulomb": {"level": 0.3},
        "position_dependent_friction": {"amplitude": 0.4, "period": 0.9, "phase": 0.4},
        "load_dependent_friction": {"coefficient": 0.1},
        "friction_drift": {"fraction": 0.3, "time_constant": 1.0},
        "cogging": {"amplitude": 0.2, "period": 0.57, "phase": 1.0},
        "cogging_harmonic": {"amplitude": 0.1, "period": 0.285, "phase": 0.3},
        "gravity": {"amplitude": 0.2, "phase": 0.3},
        "torque_ripple": {"amplitude": 0.1, "period": 0.5, "phase": 0.0},
    }
    for name, values in stated.items():
        body = body.with_effect(EFFECTS[name], values)
    return body


@pytest.fixture(scope="module")
def compensated():
    return td.haptic_interface(device(), cancellation=td.cancel(device(), smoothing_velocity=0.01))


def force_error(diagram, computer):
    motion = td.sine(amplitude=0.8, frequency=0.5)
    run = td.simulate_diagram(diagram, duration=2.0, motion={"L": motion}, computer=computer)
    return float(np.sqrt(np.mean(np.asarray(run["E"]) ** 2)))


def test_one_sampled_law_cancels_all_effects_along_a_motion(compensated):
    computer = td.Sampling(period=2e-4, delay=0.0, velocity_bandwidth=500.0)
    without = force_error(compensated.without("C"), computer)
    # left: smoothing near reversals, a sample of delay, and the mu of what C itself adds
    assert force_error(compensated, computer) < 0.15 * without


def test_file_of_a_diagram_holds_the_law(compensated, tmp_path):
    path = tmp_path / "compensated.toml"
    td.write_diagram(compensated, path)
    assert td.read_diagram(path) == compensated
    assert pickle.loads(pickle.dumps(compensated)) == compensated


@pytest.mark.parametrize("shape", [(), ("presliding",)])
def test_file_holds_a_law_that_has_nothing_left_to_smooth(shape, tmp_path):
    names = ("coulomb", *shape) if shape else ("cogging",)
    values = {n: dict.fromkeys(EFFECTS[n].parameters, 0.5) for n in names}
    law = td.cancel(values, smoothing_velocity=0.02)
    diagram = td.haptic_interface(td.hand(mass=0.2, damping=1.0, stiffness=0.0), cancellation=law)
    td.write_diagram(diagram, tmp_path / "diagram.toml")
    assert td.read_diagram(tmp_path / "diagram.toml") == diagram


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_c_header_steps_like_the_law(tmp_path):
    law = td.cancel(device(), smoothing_velocity=0.01)
    (tmp_path / "law.h").write_text(as_c_header(law, period=1e-3, name="law"))
    (tmp_path / "main.c").write_text(
        '#include <stdio.h>\n#include "law.h"\n'
        "int main(void) { law_state s; law_start(&s); double u = 0.0;\n"
        "for (int k = 0; k < 1001; k++) u = law_step(&s, 0.4, 0.3, 0.3, 0.5);\n"
        'printf("%.15g", u); return 0; }\n'
    )
    subprocess.run(["cc", "main.c", "-lm", "-o", "main"], cwd=tmp_path, check=True)
    ran = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True)
    stage = law.stages[0]
    now = {"input": 0.4, "velocity": 0.3, "speed": 0.3, "command": 0.5, "time": 1.0}
    expected = stage.law.law(SimpleNamespace(**now), SimpleNamespace(**stage.values))
    assert float(ran.stdout) == pytest.approx(float(expected), rel=1e-9)


@pytest.mark.parametrize(
    "more, smoothing", [({}, 0.02), ({"presliding": {"stiffness": 50.0}}, None)]
)
def test_passivity_of_cancelled_friction_is_proved_as_for_the_law_of_that_name(more, smoothing):
    body = td.Body("revolute", {"inertia": 0.01})
    body = body.with_effect(EFFECTS["coulomb"], {"level": 0.3})
    body = body.with_effect(EFFECTS["viscous"], {"damping": 0.02})
    law = td.cancel({"coulomb": {"level": 0.27}, **more}, smoothing_velocity=smoothing)
    claims = td.diagram_claims(td.haptic_interface(body, cancellation=law)).claims
    assert any(c.claim.status == "proved" for c in claims if c.topic == "friction of Z_M with C")


def test_a_spring_that_is_cancelled_in_part_is_a_softer_spring():
    """Its linear form; readings count from the spring's neutral position."""
    device = td.Body("prismatic", {"inertia": 0.35}).with_effect(EFFECTS["viscous"], {"damping": 2})
    stiff = device.with_effect(EFFECTS["spring"], {"stiffness": 25.0})
    soft = device.with_effect(EFFECTS["spring"], {"stiffness": 5.0})
    partly = td.haptic_interface(stiff, cancellation=td.cancel({"spring": {"stiffness": 20.0}}))
    s = 2j * np.pi * np.array([0.1, 1.0, 30.0])
    forms = [
        td.frequency.transfer_function(d, output="L", input="R_D")
        for d in (partly, td.haptic_interface(soft))
    ]
    assert [left for _, left in forms] == [(), ()]
    np.testing.assert_allclose(forms[0][0](s), forms[1][0](s), rtol=1e-12)


def test_a_coefficient_that_is_zero_makes_no_law_linear():
    """Claims over ranges of values have it at others, too; a constant that is zero adds nothing."""
    quantities = {"stiffness": "stiffness", "square": "stiffness", "force": "force"}
    values = {"stiffness": 2.0, "square": 0.0, "force": 0.0}
    for law, broken in (
        (lambda now, p: p.stiffness * now.input + p.square * now.input**2, True),
        (lambda now, p: p.stiffness * now.input + p.force, False),
    ):
        made = ControlLaw(
            law=law, parameters={n: Parameter(q, n) for n, q in quantities.items()}, linear=True
        ).named("mine", "")
        assert bool(broken_declarations(made, Stage(made, values))) is broken
        assert broken_declarations(made, Stage(made, values | {"force": 1.0, "square": 1.0}))
