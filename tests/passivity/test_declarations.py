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
    ControllerState,
    Stage,
    broken_declarations,
    controller,
    load_controller,
)
from teleopdesign.diagrams import haptic_interface, wave_variables
from teleopdesign.effects import BLOCK_EFFECTS, Parameter, load_effect
from teleopdesign.passivity import Search, diagram_claims, ports
from teleopdesign.passivity.declarations import (
    falsely_linear,
    is_kept,
    is_shipped,
    underived_energy,
)
from teleopdesign.passivity.diagram_claims import composed_claim, friction_pairs, pair_claims
from teleopdesign.passivity.law_facts import ANY_TIME, CONTINUOUS, law_facts
from teleopdesign.passivity.theorems.wave_channel import wave_claim

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


STATE = '{"z": State("position", lambda now, p: now.velocity - now.z)}'
BRISTLE_OF = '{"z": State("position", lambda now, p: now.velocity - Abs(now.velocity) * now.z)}'
INNER = '{"z": State("position", lambda now, p: now.position - now.z)}'
PUSHED = '{"z": State("position", lambda now, p: 2 * now.velocity - now.z)}'
DISSIPATES = 'energy="dissipates"'

FALSE = {
    "negative damping": ("-p.size * now.velocity", DISSIPATES, "{}"),
    "a push in one direction": ("-p.size * (now.velocity + Abs(now.velocity))", DISSIPATES, "{}"),
    "a push at low speed": ("-p.size * now.velocity * exp(-now.velocity**2)", DISSIPATES, "{}"),
    "a push by a state": ("-p.size * now.z", DISSIPATES, STATE),
    "damping that stores": ("-p.size * now.velocity", 'energy="stores"', "{}"),
    "a force of the time": ("p.size * now.time", 'energy="stores"', "{}"),
    "a late spring": ("p.size * delayed(now.position, 0.01)", 'energy="stores"', "{}"),
    "a late damper": ("p.size * delayed(now.velocity, 0.01)", DISSIPATES, "{}"),
    "a potential without end": ("-p.size * now.position**3", 'energy="stores"', "{}"),
    "a negative inertia": ("-p.size * now.acceleration", 'energy="stores"', "{}"),
    "a spring of another body": ("p.size * now.other_position", 'energy="stores"', "{}"),
    "a state that is led by force": ("p.size * now.z", DISSIPATES, PUSHED),
    "a push that reverses late": ("-p.size * (now.velocity - now.z)", DISSIPATES, STATE),
}


@pytest.mark.parametrize(("law", "more", "states"), FALSE.values(), ids=FALSE)
def test_a_declaration_about_energy_that_is_false_proves_nothing(tmp_path, law, more, states):
    mine = effect(tmp_path, law, more, states=states)
    device = with_friction(mine)
    assert list(underived_energy(device, errors=1.96)) == ["mine"]
    topics, text = proved(haptic_interface(device, cancellation=DAHL))
    assert topics == [] and "mine declares to supply none" in text


TRUE = {
    "damping": ("p.size * now.velocity", DISSIPATES, "{}"),
    "drag": ("p.size * now.velocity * Abs(now.velocity)", DISSIPATES, "{}"),
    "damping that fades at rest": (
        "p.size * now.velocity * (1 - exp(-now.velocity**2))", DISSIPATES, "{}"),
    "damping at a place": ("p.size * now.velocity * now.position**2", DISSIPATES, "{}"),
    "a spring that hardens": ("p.size * now.position**3", 'energy="stores"', "{}"),
    "a spring that softens": ("p.size * tanh(now.position)", 'energy="stores"', "{}"),
    "a wave along the way": ("p.size * sin(now.position / 3)", 'energy="stores"', "{}"),
    "an inertia": ("p.size * now.acceleration", 'energy="stores"', "{}"),
    "a Maxwell element": ("p.size * now.z", DISSIPATES, STATE),
    "a bristle": ("p.size * now.z", DISSIPATES, BRISTLE_OF),
    "an inner point behind a spring": ("p.size * (now.position - now.z)", DISSIPATES, INNER),
    "a spring, a damper and a state": (
        "p.size * (now.z + now.position + now.velocity)", DISSIPATES, STATE),
}  # fmt: skip


@pytest.mark.parametrize(("law", "more", "states"), TRUE.values(), ids=TRUE)
def test_a_declaration_about_energy_that_follows_from_the_law_counts(tmp_path, law, more, states):
    device = with_friction(effect(tmp_path, law, more, states=states))
    assert underived_energy(device, errors=1.96) == {}
    assert proved(haptic_interface(device, cancellation=DAHL))[0]


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
    stage = controller(mine, {"level": 0.4, "second": 0.01}).stages[0]
    assert (law_facts(stage, CONTINUOUS).bound is not None) is kept


@pytest.mark.slow
@pytest.mark.parametrize(("law", "kept"), BOUNDS.values(), ids=BOUNDS)
def test_a_claim_rests_on_a_bound_only_where_it_is_kept(tmp_path, law, kept):
    mine = load_controller(law_file(tmp_path, law, 'bound="level"'))
    made = controller(mine, {"level": 0.4, "second": 0.01})
    assert (law_facts(made.stages[0], ANY_TIME).bound is not None) is kept
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


VALUES = {"level": 0.4, "second": 0.01}
PARAMETERS = {"level": Parameter("force", "F"), "second": Parameter("velocity", "a")}


def anti_damping(now, p):
    return 1000 * p.level * now.velocity


def smoothed(now, p):
    return p.level * now.velocity / (p.second + now.speed)


def lagging(now, p):
    return 100 * (smoothed(now, p) - now.z)


def of_level(law, states=None, **more):
    made = ControlLaw(law=law, parameters=PARAMETERS, states=states or {}, bound="level", **more)
    return controller(made.named("mine", "A law."), VALUES)


def one(values, z):
    return sp.S(1)


SWITCHES = {
    "shift": dict(shift=one),
    "shift and a shape": dict(shift=one, smoothing="second"),
    "shift, linear": dict(shift=one, linear=True),
    "a shape": dict(smoothing="second"),
    "a bristle": dict(bristle_stiffness="second"),
    "a transfer function": dict(transfer=one, linear=True),
    "a source": dict(source="python-control"),
    "a name": dict(name="dahl"),
}
#: of these each search for a motion takes seconds, and others are like them
FURTHER = {"shift", "shift, linear", "a shape", "a source", "a transfer function"}


@pytest.mark.parametrize(
    "more",
    [pytest.param(more, id=name, marks=[pytest.mark.slow] * (name in FURTHER))
     for name, more in SWITCHES.items()],
)  # fmt: skip
def test_nothing_that_a_law_says_of_itself_switches_a_check_off(more):
    """Its force grows without end, whatever else it declares; and a search releases energy."""
    diagram = haptic_interface(with_friction(), cancellation=of_level(anti_damping, **more))
    claims = diagram_claims(diagram, search=Search(tries=3)).claims
    assert all(one.claim.status != "proved" for one in claims)
    assert claims[-1].claim.status == "refuted" and claims[-1].replayed > 0
    assert "could not be shown to stay within 0.4" in str(claims[0].claim.verdict)


def rate(now, p):
    return now.travel_rate - sp.Abs(now.travel_rate) * now.z / p.second


def forward_euler(now, p):
    return now.z + now.period * (now.velocity - now.speed * now.z / p.second)


def one_step(law):
    return {"z": ControllerState("force", lagging, law)}


def of_period(factor):
    return lambda now, p: smoothed(now, p) * factor(now.period)


RIGHT_IN = {
    "continuous time: a factor of the period": (of_level(of_period(lambda T: 1 + 1000 * T)), 0),
    "continuous time: another law in a computer": (
        of_level(smoothed, sampled=lambda v, T: controller("gain", {"gain": 1e3}).stages[0]), 0),
    "continuous time: forward Euler of a bristle": (
        of_level(lambda now, p: p.level * now.z / p.second,
                 {"z": ControllerState("position", rate, forward_euler)}), 0),
    "a computer up to its period: forward Euler of a lag": (
        of_level(lambda now, p: now.z, one_step(lambda now, p: now.z + now.period * lagging(now, p))
                 ), 0.01),
    "any time: a lag": (of_level(lambda now, p: now.z, {"z": ControllerState("force", lagging)}),
                        float("inf")),
    "any time: a lag with a step of its own": (
        of_level(lambda now, p: now.z, one_step(
            lambda now, p: smoothed(now, p) + (now.z - smoothed(now, p)) * sp.exp(-now.period))),
        float("inf")),
}  # fmt: skip


@pytest.mark.parametrize(("law", "longest"), RIGHT_IN.values(), ids=RIGHT_IN)
def test_a_bound_counts_for_the_periods_in_which_the_law_keeps_it(law, longest):
    (stage,) = law.stages
    assert law_facts(stage, CONTINUOUS).bound == 0.4
    for period in (1e-3, 1e-2, 0.03):
        kept = law_facts(stage, (period, period)).bound is not None
        assert kept is (period <= longest)
    always = law_facts(stage, ANY_TIME)
    assert (always.bound is not None) is (longest == float("inf"))
    diagram = haptic_interface(with_friction(), cancellation=law)
    (first, *_) = pair_claims(friction_pairs(diagram)[0], simulated=False)
    assert first.claim.status == "proved"
    assert first.time == ("any" if longest == float("inf") else "continuous")
    assert bool(always.missing) is (first.time == "continuous")


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


def test_a_transfer_function_is_held_against_the_values_that_it_is_used_with():
    """At a gain of 1 both are the same."""
    law = ControlLaw(
        law=lambda now, p: p.level * now.input,
        parameters={"level": Parameter("dimensionless", "k", lower=-9.0)},
        transfer=lambda values, s: sp.Rational(values["level"]) ** 2,
        linear=True,
    ).named("mine", "A law.")
    assert is_kept(Stage(law, {"level": 1.0})) and not is_kept(Stage(law, {"level": 2.0}))
