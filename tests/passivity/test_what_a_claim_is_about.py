"""A claim is about the device, the law and the signals that it names, not about ones like them."""

import math

import control as ct
import pytest
import sympy as sp
from devices import body

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import ControlLaw, ControllerState, controller, from_control
from teleopdesign.design.verdict import feedback_claim
from teleopdesign.diagrams import Control, Diagram, Junction, Moving, haptic_interface
from teleopdesign.effects import EFFECTS, Effect, Parameter, State, delayed
from teleopdesign.frequency import loop_gain
from teleopdesign.passivity import claim_over_intervals
from teleopdesign.passivity.diagram_claims import composed_claim
from teleopdesign.passivity.friction_pairs import friction_pairs
from teleopdesign.passivity.identified import identify_device
from teleopdesign.passivity.law_facts import ANY_TIME, law_facts
from teleopdesign.passivity.ports import ports
from teleopdesign.passivity.theorems import Question, Wall, settle
from teleopdesign.realise.reach import Reach

LEVEL, EDGE = Parameter("force", "F"), Parameter("velocity", "e", lower=1e-6)
SIZE = {"size": Parameter("dimensionless", "k")}
ROD = body(coulomb__level=0.5, viscous__damping=10.0)
DAHL = controller("dahl", {"level": 0.6, "stiffness": 1e4})


def with_effect(name, value=1.0, **declared):
    effect = Effect(absent={"size": 0.0}, parameters=SIZE, **declared).named(name, "x")
    return body(coulomb__level=0.5).with_effect(effect, {"size": value})


def law_of(law, **more):
    made = ControlLaw(law=law, parameters={"level": LEVEL, "edge": EDGE}, bound="level", **more)
    return controller(made.named("mine", "x"), {"level": 0.6, "edge": 0.01})


def test_a_state_that_counts_up_keeps_no_bound():
    count = ControllerState(
        "dimensionless", lambda now, p: sp.S(0), lambda now, p: now.z + sp.tanh(now.speed / p.edge)
    )
    push = lambda now, p: p.level * now.z * now.velocity / (p.edge + now.speed)  # noqa: E731
    law = law_of(push, states={"z": count})
    assert law_facts(law.stages[0], ANY_TIME).bound is None


@pytest.mark.parametrize("presliding", [None, 1e3])
def test_friction_that_gives_first_does_not_hold_a_wall_on_encoder_steps(presliding):
    device = body(coulomb__level=0.5, viscous__damping=5.0)
    if presliding:
        gives = EFFECTS["presliding"].without("bristle_damping")
        device = device.with_effect(gives, {"stiffness": presliding})
    computer = td.Sampling(period=1e-3, encoder_step=1e-4)
    question = Question(identify_device(device), wall=Wall(5000.0, 0.0), computer=computer)
    (claim,) = (s.claim for s in settle(question) if s.topic == "virtual wall, encoder steps")
    assert claim.status == ("unknown" if presliding else "proved")


def test_a_force_of_a_state_alone_is_no_force_of_the_place():
    lags = State("position", lambda now, p: -now.velocity - now.z)
    mine = with_effect(
        "mine", 200.0, role="force", energy="dissipates", states={"z": lags},
        law=lambda now, p: p.size * sp.tanh(now.z),
    )  # fmt: skip
    reach = Reach(
        low=-0.1, high=0.1, peak_speed=1.0, rms_speed=0.3, command=5.0, duration=10.0,
        sample_period=1e-3, step=0.0, unresolved=1e-5, measures_force=True,
    )  # fmt: skip
    assert "mine" in identify_device(mine, reach).left_open


@pytest.mark.parametrize(
    ("law", "least"),
    [
        (lambda now, p: now.command + 5 * p.size * (now.command - delayed(now.command, 2e-3)), 4.4),
        (lambda now, p: p.size * delayed(3 * now.command, 2e-3), 1.2),
        (lambda now, p: now.command + p.size * delayed(now.velocity, 2e-3), math.inf),
    ],
)
def test_an_earlier_signal_is_another_number_than_the_present_one(law, least):
    device = identify_device(with_effect("late", role="actuation", law=law))
    assert device.acting_force(0.4) == pytest.approx(least)
    dahl = controller("dahl", {"level": 0.4, "stiffness": 1e6})
    assert not any(s.claim.holds for s in settle(Question(device, dahl.stages[0])))


def test_a_lagging_speed_that_falls_below_rest_leaves_no_bound_of_the_friction():
    falls = with_effect("level", 0.3, role="friction_level",
                        law=lambda now, p: p.size * (1 - sp.exp(-now.velocity / 0.1)))  # fmt: skip
    lags = State("velocity", lambda now, p: (sp.Abs(now.velocity) - 0.2 * p.size - now.z) / 0.05)
    speed = Effect(
        role="friction_speed", law=lambda now, p: now.z, states={"z": lags}, parameters=SIZE,
        absent={"size": 0.0},
    ).named("speed", "x")  # fmt: skip
    with pytest.raises(ModelError, match="no guaranteed bound"):
        identify_device(falls.with_effect(speed, {"size": 1.0}))


def test_a_users_effect_by_a_shipped_name_is_not_proved_by_the_vertices_of_a_box():
    knob = Effect(
        role="friction_level", energy="dissipates", absent={"level": -1.0},
        parameters={"level": Parameter("force", "place of a knob")},
        law=lambda now, p: sp.Rational(6, 10) + sp.cos(8 * sp.pi * p.level) / 2,
    ).named("coulomb", "x")  # fmt: skip
    device = body(viscous__damping=1.0).with_effect(knob, {"level": 0.5})
    dahl = controller("dahl", {"level": 0.4, "stiffness": 1e4})
    diagram = haptic_interface(device, cancellation=dahl)
    assert claim_over_intervals(diagram, {"Z_M.coulomb.level": (0.0, 1.0)}).status != "proved"


def brake():
    return law_of(lambda now, p: -p.level * now.velocity / (p.edge + now.speed))


def smoothed():
    return controller("smoothed_coulomb", {"level": 0.6, "smoothing_velocity": 0.05})


@pytest.mark.parametrize(("law", "status"), [(brake, "unknown"), (smoothed, "evidence")])
def test_what_another_law_of_the_bound_releases_refutes_no_box(law, status):
    diagram = haptic_interface(ROD, cancellation=law())
    assert claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)}).status == status


@pytest.mark.parametrize(("spent", "proved"), [(0.0, True), (9.0, True), (-1.0, False)])
def test_a_proof_that_spends_the_damping_leaves_none_to_the_rest(spent, proved):
    """The law of velocity needs damping of the body; a further damper of -1 N s/m needs it, too."""
    damper = controller("spring_damper", {"stiffness": 0.0, "damping": spent})
    blocks = (
        Moving("M", ROD, "x", "u", {"f": 1}, "f"),
        Control("C", smoothed(), "x", "F1", "x"),
        Control("D", damper, "y", "F2", "y"),
    )
    sums = Junction("u", {"F1": 1, "F2": -1}), Junction("y", {"x": 1})
    diagram = Diagram("damped", blocks, sums, {"f": "force"}, ("x",))
    claim = composed_claim(diagram, ports(diagram), friction_pairs(diagram))
    assert (claim is not None) == proved


def test_a_law_that_releases_energy_is_refuted_over_a_box_unless_another_one_brakes():
    moving = Moving("M", ROD, "x", "u", {"f": 1}, "f")
    helps = Control("C", DAHL, "x", "F1", "x")
    brakes = Control("B", controller("coulomb", {"level": 1.0}), "y", "F2", "y")
    sums = Junction("u", {"F1": 1}), Junction("u", {"F1": 1, "F2": -1})
    alone = Diagram("one", (moving, helps), sums[:1], {"f": "force"}, ("x",))
    both = (sums[1], Junction("y", {"x": 1}))
    beside = Diagram("two", (moving, helps, brakes), both, {"f": "force"}, ("x",))
    box = {"M.inertia": (0.1, 0.2)}
    assert claim_over_intervals(alone, box).status == "refuted"
    assert claim_over_intervals(beside, box).status == "unknown"


@pytest.mark.parametrize("name", ["actuator_lag", "actuator_saturation"])
def test_the_claim_of_a_design_on_feedback_has_the_actuator_or_names_it(name):
    values = {"actuator_lag": {"time_constant": 0.02}, "actuator_saturation": {"limit": 5.0}}
    device = body(viscous__damping=2.0).with_effect(EFFECTS[name], values[name])
    claim = feedback_claim(device, controller("gain", {"gain": 1.0}))
    assert (name in claim.statement) == (name == "actuator_saturation")


@pytest.mark.parametrize(("rate", "status"), [(-2.0, "proved"), (2.0, "unknown")])
def test_the_claim_of_a_design_counts_what_the_feedback_hides(rate, status):
    hides = ct.ss([[-10.0, 0.0], [0.0, rate]], [[1.0], [1.0]], [[1.0, 0.0]], [[0.5]])
    claim = feedback_claim(body(viscous__damping=2.0), from_control(hides))
    assert claim.status == status


def test_a_stated_transfer_function_holds_at_the_values_that_run():
    squared = ControlLaw(
        law=lambda now, p: p.g**2 * now.input, parameters={"g": Parameter("stiffness", "g")},
        linear=True, transfer=lambda values, s: values["g"],
    ).named("squared", "x")  # fmt: skip

    def loop(gain):
        part = Control("P", controller(squared, {"g": gain}), "x", "F", "x")
        moving = Moving("M", body(viscous__damping=2.0), "x", "u", {"f": 1}, "f")
        return Diagram("loop", (moving, part), (Junction("u", {"F": -1}),), {"f": "force"}, ("x",))

    loop_gain(loop(1.0), controller="P")
    with pytest.raises(ModelError, match="squared: at these values it declares a transfer"):
        loop_gain(loop(20.0), controller="P")


def test_a_damper_elsewhere_keeps_a_law_of_velocity_from_being_refuted():
    device = body(coulomb__level=0.5, viscous__damping=1.0)
    damper = controller("spring_damper", {"stiffness": 0.0, "damping": 10.0})
    helps = controller("smoothed_coulomb", {"level": 0.9, "smoothing_velocity": 0.05})
    blocks = (
        Moving("M", device, "x", "u", {"f": 1}, "f"),
        Control("C", helps, "x", "F1", "x"),
        Control("D", damper, "y", "F2", "y"),
    )
    sums = Junction("u", {"F1": 1, "F2": -1}), Junction("y", {"x": 1})
    diagram = Diagram("damped", blocks, sums, {"f": "force"}, ("x",))
    assert claim_over_intervals(diagram, {"M.inertia": (0.1, 0.2)}).status == "unknown"


@pytest.mark.parametrize("velocity", ["difference", "observer"])
def test_a_sampled_wall_is_proved_for_the_velocity_that_the_theorem_takes(velocity):
    bandwidth = math.inf if velocity == "difference" else 600.0
    computer = td.Sampling(period=1e-3, velocity=velocity, velocity_bandwidth=bandwidth)
    device = identify_device(body(coulomb__level=1e-6, viscous__damping=5.0))
    (claim,) = (s.claim for s in settle(Question(device, wall=Wall(300.0, 4.8), computer=computer)))
    assert claim.status == ("proved" if velocity == "difference" else "unknown")


def test_two_parameters_with_one_symbol_are_refused():
    mine = Effect(
        role="force", law=lambda now, p: p.load_size * now.velocity, absent={"load_size": 0.0},
        parameters={"load_size": Parameter("damping", "c")},
    ).named("my", "x")  # fmt: skip
    other = Effect(
        role="force", law=lambda now, p: p.size * now.position, absent={"size": 0.0},
        parameters={"size": Parameter("stiffness", "c")},
    ).named("my_load", "x")  # fmt: skip
    device = body().with_effect(mine, {"load_size": 3.0}).with_effect(other, {"size": 7.0})
    with pytest.raises(ModelError, match="my_load.size have one symbol"):
        haptic_interface(device)
    with pytest.raises(ModelError, match="have one symbol"):
        device.numbers()


@pytest.mark.parametrize(
    "more",
    [
        {"stribeck__extra_static_level": 0.5, "stribeck__stribeck_velocity": 0.01},
        {
            "position_dependent_friction__amplitude": 0.5,
            "position_dependent_friction__period": 1e-3,
            "position_dependent_friction__phase": 0.0,
        },
    ],
)
def test_a_cycle_at_the_least_level_refutes_no_friction_whose_level_varies(more):
    device = body(coulomb__level=0.5, viscous__damping=50.0, **more)
    diagram = haptic_interface(device, cancellation=DAHL)
    assert claim_over_intervals(diagram, {"Z_M.inertia": (0.1, 0.2)}).status == "unknown"


def test_a_study_tells_a_law_of_velocity_that_releases_energy():
    whole = haptic_interface(
        body(coulomb__level=0.5, viscous__damping=0.01), cancellation=smoothed()
    )
    made = td.study(whole, {"Z_M.inertia": [0.15]}, measures="passivity", duration=0.01, workers=1)
    assert str(made.data["passivity_status"].values.item()) == "refuted"


def test_two_laws_at_two_ports_are_refuted_by_a_motion_of_one():
    link = controller("spring_damper", {"stiffness": 200.0, "damping": 3.0})
    side = body(coulomb__level=0.5, viscous__damping=2.0)
    diagram = td.teleoperator(
        side, side, coupling=link, master_cancellation=DAHL, slave_cancellation=DAHL
    )
    assert claim_over_intervals(diagram, {"Z_m.inertia": (0.1, 0.2)}).status == "refuted"


def test_a_parameter_has_no_symbol_of_a_signal_or_of_a_state():
    loaded = Effect(
        role="friction_level", absent={"force": 0.0},
        parameters={"force": Parameter("dimensionless", "share")},
        law=lambda now, p: p.force * sp.Abs(now.interaction_force),
    ).named("interaction", "x")  # fmt: skip
    twice = Effect(
        role="force", absent={"z": 0.0}, parameters={"z": Parameter("damping", "c")},
        states={"z": State("velocity", lambda now, p: -now.z)}, law=lambda now, p: now.z,
    ).named("mine", "x")  # fmt: skip
    for effect, value in ((loaded, {"force": 0.6}), (twice, {"z": 3.0})):
        with pytest.raises(ModelError, match="have one symbol"):
            body(coulomb__level=0.5).with_effect(effect, value).numbers()
