"""A false declaration in a user's file proves nothing: the tests write such files on purpose."""

from dataclasses import replace

import pytest
import sympy as sp
from devices import body

from teleopdesign import EFFECTS
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import (
    CONTROLLERS,
    ControlLaw,
    broken_declarations,
    controller,
    load_controller,
)
from teleopdesign.diagrams import haptic_interface, wave_variables
from teleopdesign.effects import BLOCK_EFFECTS, Parameter, load_effect
from teleopdesign.passivity import ports, wave_claim
from teleopdesign.passivity.declarations import (
    falsely_linear,
    is_shipped,
)
from teleopdesign.passivity.diagram_claims import composed_claim
from teleopdesign.passivity.friction_pairs import friction_pairs, pair_claims
from teleopdesign.passivity.ports import nonlinear_parts

DAHL = controller("dahl", {"level": 0.4, "stiffness": 1e4})
EFFECT_FILE = '''"""An effect of one's own."""
from sympy import Abs, exp, sin, tanh
from teleopdesign.effects import Effect, Parameter, State, delayed

EFFECT = Effect(
    role="{role}",
    law=lambda now, p: {law},
    parameters={{"size": Parameter("dimensionless", "how much", lower=0.0)}},
    absent={{"size": 0.0}},
    states={states},
    {more}
)
'''
LAW_FILE = '''"""A law of one's own."""
from sympy import Abs, sqrt, tanh
from teleopdesign.controllers import ControlLaw, ControllerState
from teleopdesign.effects import Parameter, delayed

CONTROLLER = ControlLaw(
    law=lambda now, p: {law},
    parameters={{
        "level": Parameter("force", "F"),
        "second": Parameter("velocity", "a"),
    }},
    {more}
)
'''


def effect(folder, law, more, *, role="force", states="{}", name="mine"):
    path = folder / f"{name}.py"
    path.write_text(EFFECT_FILE.format(law=law, more=more, role=role, states=states))
    return load_effect(path)


def law_file(folder, law, more):
    path = folder / "my_law.py"
    path.write_text(LAW_FILE.format(law=law, more=more))
    return path


def with_friction(*effects):
    made = body(0.1, viscous__damping=1.0, coulomb__level=0.5)
    for one in effects:
        made = made.with_effect(one, {"size": 5.0})
    return made


def proved(diagram):
    """Topics that theorems prove, and all verdicts; nothing is simulated."""
    pairs = friction_pairs(diagram)
    claims = [one for pair in pairs for one in pair_claims(pair, simulated=False)]
    claims.append(composed_claim(diagram, ports(diagram), pairs))
    known = [one for one in claims if one is not None]
    return [one.topic for one in known if one.claim.status == "proved"], str(known)


def test_a_name_of_the_catalogue_makes_no_law_of_it():
    """A negative damper, and a bristle with negative damping, behind names and laws of others."""
    anti = replace(EFFECTS["viscous"], parameters={"damping": Parameter("damping", "B", lower=-9)})
    loose = Parameter("damping", "s1", lower=-99, optional=True)
    known = EFFECTS["presliding"]
    bent = replace(known, parameters={**known.parameters, "bristle_damping": loose})
    friction = body(0.1, coulomb__level=0.5)
    for device, name in (
        (friction.with_effect(anti, {"damping": -5.0}), "viscous"),
        (friction.with_effect(bent, {"stiffness": 2e4, "bristle_damping": -20.0}), "presliding"),
    ):
        assert not is_shipped(device.effect(name))
        topics, text = proved(haptic_interface(device, cancellation=DAHL))
        assert topics == [] and f"but {name} may supply energy" in text
    honest = friction.with_effect(anti, {"damping": 5.0})  # at this value it does dissipate
    assert proved(haptic_interface(honest, cancellation=DAHL))[0]


NOT_LINEAR = {
    "of the hand's force": "-p.size * now.interaction_force",
    "of degree one, and bent": "-p.size * now.velocity**2 / now.position",
    "a constant": "p.size",
    "of one direction": "-p.size * Abs(now.velocity)",
    "late by its speed": "-p.size * delayed(now.position, now.velocity)",
}


@pytest.mark.parametrize("law", NOT_LINEAR.values(), ids=NOT_LINEAR)
def test_an_effect_that_is_called_linear_and_is_not_has_no_linear_form(tmp_path, law):
    """A file is refused, so that no Bode plot has it; one made in Python counts in no claim."""
    with pytest.raises(ModelError, match=r"mine.py: declares linear = True, but its law is not"):
        effect(tmp_path, law, "linear=True")
    device = body(0.1, viscous__damping=1.0)
    false = replace(effect(tmp_path, law, ""), linear=True)
    device = device.with_effect(false, {"size": 5.0})
    assert falsely_linear(haptic_interface(device)) == ["Z_M.mine"]


def memory(rate):
    return f'states={{"z": ControllerState("force", lambda now, p: {rate})}}'


SHAPE = "-p.level * now.velocity / (p.second + now.speed)"
BRISTLE, LATE = 'bristle_stiffness="second"', "-5 * delayed(now.input, p.second)"
STATED = "transfer=lambda values, s: values['level'] / (s + 1)"
FALSE_LAWS = {
    "smoothing": (SHAPE, 'bound="level", smoothing="second"'),
    "bristle_stiffness": (
        "p.second * now.z",
        f'bound="level", {BRISTLE}, {memory("now.travel_rate")}',
    ),
    "dead_time": (LATE, 'dead_time="second"'),
    "linear": ("p.level * now.input**2 / now.velocity", "linear=True"),
    "linear, of a constant": ("p.level", "linear=True"),
    "filter_bandwidth": ("now.z", f'filter_bandwidth="second", {memory("p.second * now.input")}'),
    "transfer function": ("p.level * now.input", f"linear=True, {STATED}"),
}


@pytest.mark.parametrize(("what", "parts"), FALSE_LAWS.items(), ids=FALSE_LAWS)
def test_a_law_that_does_not_do_what_it_declares_is_refused(tmp_path, what, parts):
    with pytest.raises(ModelError, match=f"declares a? ?{what.partition(',')[0]}"):
        load_controller(law_file(tmp_path, *parts))


@pytest.mark.parametrize("name", CONTROLLERS)
def test_laws_of_the_catalogue_do_what_they_declare(name):
    assert broken_declarations(CONTROLLERS[name]) == ()


@pytest.mark.parametrize("name", [*EFFECTS, *BLOCK_EFFECTS])
def test_effects_of_the_catalogue_are_known_as_such(name):
    known = {**EFFECTS, **BLOCK_EFFECTS}[name]
    assert is_shipped(known)
    for left_out in (n for n, p in known.parameters.items() if p.optional):
        assert is_shipped(known.without(left_out))


def test_an_effect_called_coulomb_is_not_coulomb_friction_for_waves(tmp_path):
    """Its negative damping has no linear form; by its name it was left aside."""
    mine = effect(tmp_path, "-p.size * now.velocity", "", name="coulomb")
    slide = body(0.1, viscous__damping=1.0)
    law = controller("proportional_integral", {"gain": 5.0, "rate": 20.0})

    def waves(master):
        return wave_variables(master, slide, wave_impedance=5.0, coupling=law, delay=0.1)

    assert wave_claim(waves(slide.with_effect(mine, {"size": 50.0}))).status == "unknown"
    honest = slide.with_effect(EFFECTS["coulomb"], {"level": 0.5})
    assert wave_claim(waves(honest)).status == "proved"


VALUES = {"level": 0.4, "second": 0.01}
PARAMETERS = {"level": Parameter("force", "F"), "second": Parameter("velocity", "a")}


def anti_damping(now, p):
    return 1000 * p.level * now.velocity


def of_level(law, states=None, **more):
    made = ControlLaw(law=law, parameters=PARAMETERS, states=states or {}, bound="level", **more)
    return controller(made.named("mine", "A law."), VALUES)


def one(values, z):
    return sp.S(1)


SWITCHES = {
    "a shape": dict(smoothing="second"),
    "a bristle": dict(bristle_stiffness="second"),
    "a transfer function": dict(transfer=one, shift=one, linear=True),
    "a source": dict(source="python-control"),
    "a name": dict(name="dahl"),
}


def test_nothing_that_a_law_says_of_itself_switches_a_check_off():
    """Its force grows without end, whatever else it declares."""
    for more in SWITCHES.values():
        made = haptic_interface(with_friction(), cancellation=of_level(anti_damping, **more))
        topics, text = proved(made)
        assert topics == [] and "could not be shown to stay within 0.4" in text, more


def test_the_file_of_a_law_may_state_the_step_of_a_state(tmp_path):
    states = """states={"z": ControllerState("force", lambda now, p: -p.second * now.z,
        lambda now, p: now.z + now.period * now.input)}"""
    law = load_controller(law_file(tmp_path, "p.level * now.z", states))
    assert list(law.states) == ["z"]
    stray = states.replace("now.period", "Symbol('speed_of_light')").replace("sympy", "sympy")
    path = law_file(tmp_path, "p.level * now.z", stray)
    path.write_text(path.read_text().replace("Abs,", "Abs, Symbol,"))
    with pytest.raises(ModelError, match="speed_of_light"):
        load_controller(path)


STEP = """states={"z": ControllerState("force", lambda now, p: 0, lambda now, p: now.input)}"""
PERIODIC = '"period": Parameter("time", "T"), "level"'


@pytest.mark.parametrize(("stated", "right"), [("1 / z", True), ("1", False), ("2 / z", False)])
def test_a_stated_transfer_function_in_z_is_that_of_the_steps(tmp_path, stated, right):
    shift = f"shift=lambda values, z: values['level'] * {stated}, {STEP}"
    path = law_file(tmp_path, "p.level * now.z", shift)
    path.write_text(path.read_text().replace('"level"', PERIODIC, 1))
    if right:
        assert load_controller(path).in_z is not None
        return
    with pytest.raises(ModelError, match="declares shift"):
        load_controller(path)


def test_a_law_whose_speed_cancels_in_its_transfer_function_is_not_linear(tmp_path):
    """It reads what it kept at one speed at another one; a tremble then loads a negative spring."""
    size = "(1 + 10 * now.speed)"
    keeps = memory(f"now.input * {size} - now.z")
    law = load_controller(law_file(tmp_path, f"-p.level * now.z / {size}", f"linear=True, {keeps}"))
    made = controller(law, {"level": 3.0, "second": 0.1})
    device = body(0.1, viscous__damping=2.0, spring__stiffness=10.0)
    assert nonlinear_parts(haptic_interface(device, force_feedback=made)) == ("H",)
