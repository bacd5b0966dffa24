"""A false declaration in a user's file proves nothing: the tests write such files on purpose."""

from dataclasses import replace

import pytest
from devices import body

from teleopdesign import EFFECTS
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import (
    CONTROLLERS,
    ControlLaw,
    Stage,
    broken_declarations,
    controller,
    load_controller,
)
from teleopdesign.diagrams import haptic_interface, wave_variables
from teleopdesign.effects import BLOCK_EFFECTS, Parameter, load_effect
from teleopdesign.passivity import ports
from teleopdesign.passivity.declarations import (
    falsely_linear,
    is_kept,
    is_shipped,
    keeps_its_bound,
    unchecked_energy,
)
from teleopdesign.passivity.diagram_claims import composed_claim
from teleopdesign.passivity.friction_pairs import friction_pairs, pair_claims
from teleopdesign.passivity.theorems.wave_channel import wave_claim

DAHL = controller("dahl", {"level": 0.4, "stiffness": 1e4})
EFFECT_FILE = '''"""An effect of one's own."""
from sympy import Abs, exp
from teleopdesign.effects import Effect, Parameter, State

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


STATE = '{"z": State("position", lambda now, p: now.velocity - now.z)}'
DISSIPATES = 'energy="dissipates"'

FALSE = {
    "negative damping": ("-p.size * now.velocity", DISSIPATES, "{}"),
    "a push in one direction": ("-p.size * (now.velocity + Abs(now.velocity))", DISSIPATES, "{}"),
    "a push at low speed": ("-p.size * now.velocity * exp(-now.velocity**2)", DISSIPATES, "{}"),
    "a push by a state": ("-p.size * now.z", DISSIPATES, STATE),
    "damping that stores": ("-p.size * now.velocity", 'energy="stores"', "{}"),
    "a force of the time": ("p.size * now.time", 'energy="stores"', "{}"),
}


@pytest.mark.parametrize(("law", "more", "states"), FALSE.values(), ids=FALSE)
def test_a_declaration_about_energy_that_is_false_proves_nothing(tmp_path, law, more, states):
    mine = effect(tmp_path, law, more, states=states)
    device = with_friction(mine)
    assert unchecked_energy(device, errors=1.96) == ("mine",)
    topics, text = proved(haptic_interface(device, cancellation=DAHL))
    assert topics == [] and "as declared by mine" in text


TRUE = {
    "damping": ("p.size * now.velocity", DISSIPATES),
    "drag": ("p.size * now.velocity * Abs(now.velocity)", DISSIPATES),
    "damping at a place": ("p.size * now.velocity * now.position**2", DISSIPATES),
    "a spring that hardens": ("p.size * now.position**3", 'energy="stores"'),
}


@pytest.mark.parametrize(("law", "more"), TRUE.values(), ids=TRUE)
def test_a_declaration_about_energy_that_the_law_shows_counts(tmp_path, law, more):
    device = with_friction(effect(tmp_path, law, more))
    assert unchecked_energy(device, errors=1.96) == ()
    assert proved(haptic_interface(device, cancellation=DAHL))[0]


def test_what_has_states_is_as_declared_and_not_proved(tmp_path):
    """A Maxwell element does take energy, which nothing here shows."""
    mine = effect(tmp_path, "p.size * now.z", DISSIPATES, states=STATE)
    topics, text = proved(haptic_interface(with_friction(mine), cancellation=DAHL))
    assert topics == [] and "which nothing has checked" in text


NOT_LINEAR = {
    "of the hand's force": "-p.size * now.interaction_force",
    "of degree one, and bent": "-p.size * now.velocity**2 / now.position",
    "a constant": "p.size",
    "of one direction": "-p.size * Abs(now.velocity)",
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


def test_an_effect_that_is_linear_counts_as_such(tmp_path):
    mine = effect(tmp_path, "p.size * (now.velocity + now.z)", "linear=True", states=STATE)
    device = body(0.1).with_effect(mine, {"size": 5.0})
    assert falsely_linear(haptic_interface(device)) == []


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


BOUNDS = {
    "ten times as much": ("10 * p.level * now.velocity / (p.second + now.speed)", False),
    "without end": ("p.level * now.velocity / p.second", False),
    "of its input": ("p.level * now.input", False),
    "half of it": ("p.level / 2 * now.velocity / (p.second + now.speed)", True),
    "all of it at last": ("p.level * now.velocity / (p.second + now.speed)", True),
    "a round edge": ("p.level * now.velocity / sqrt(p.second**2 + now.speed**2)", True),
    "a hair above": ("1.0001 * p.level * now.velocity / sqrt(p.second**2 + now.speed**2)", False),
    "a pole": ("p.level * now.velocity * p.second / (p.second - now.speed)**2", False),
    "imaginary at first": ("p.level / 2 * sqrt((now.speed - p.second) / now.speed)", False),
    "a hyperbolic tangent": ("p.level * tanh(now.velocity / p.second)", True),
}


#: forces of one direction alone: less than the bound, or twice as much
ONE_WAY = {
    f"{size} times the bound {way}": (
        f"{size} * p.level * (now.velocity {sign} now.speed) / 2 / (p.second + now.speed)",
        size < 1,
    )
    for size in (0.9, 2)
    for way, sign in (("forward", "+"), ("backward", "-"))
}


@pytest.mark.parametrize(("law", "kept"), (BOUNDS | ONE_WAY).values(), ids=BOUNDS | ONE_WAY)
def test_a_law_stays_within_its_bound_only_where_it_does_so_both_ways(tmp_path, law, kept):
    mine = load_controller(law_file(tmp_path, law, 'bound="level"'))
    assert keeps_its_bound(controller(mine, {"level": 0.4, "second": 0.01}).stages[0]) is kept


@pytest.mark.slow
@pytest.mark.parametrize(("law", "kept"), BOUNDS.values(), ids=BOUNDS)
def test_a_claim_rests_on_a_bound_only_where_it_is_kept(tmp_path, law, kept):
    mine = load_controller(law_file(tmp_path, law, 'bound="level"'))
    made = controller(mine, {"level": 0.4, "second": 0.01})
    assert keeps_its_bound(made.stages[0]) is kept
    assert bool(proved(haptic_interface(with_friction(), cancellation=made))[0]) is kept


def test_a_law_written_in_python_is_held_to_its_bound_as_well():
    law = ControlLaw(
        law=lambda now, p: -p.level * now.input,
        parameters={"level": Parameter("force", "F")},
        bound="level",
        name="mine",
    )
    made = controller(law, {"level": 0.4})
    assert proved(haptic_interface(with_friction(), cancellation=made))[0] == []


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


@pytest.mark.parametrize(("power", "kept"), [(1, True), (2, False)])
def test_a_law_that_is_no_shipped_one_is_held_against_what_it_declares(power, kept):
    """Whatever its name: that of the catalogue makes it none of the catalogue."""
    for name in ("mine", "gain"):
        law = ControlLaw(
            law=lambda now, p: p.size * now.input**power,
            parameters={"size": Parameter("dimensionless", "k")},
            linear=True,
        ).named(name, "A law.")
        assert is_kept(Stage(law, {"size": 2.0})) == kept
    assert is_kept(DAHL.stages[0]) and is_kept(controller("gain", {"gain": 2.0}).stages[0])
