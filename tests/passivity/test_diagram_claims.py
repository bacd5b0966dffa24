"""Claims about the ports of diagrams: exact, by theorem, or from a search."""

import json

import control as ct
import numpy as np
import pytest
import sympy as sp
from diagrams.several_axes import CANCELLATION, body, two_rods
from hypothesis import given, settings
from hypothesis import strategies as st

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import hand
from teleopdesign.cli import main
from teleopdesign.controllers import controller, from_control, scheduled_force_feedback
from teleopdesign.derive import block_symbol, two_port_functions
from teleopdesign.diagrams import (
    ANY,
    Control,
    Diagram,
    Junction,
    Moving,
    haptic_interface,
    read_diagram,
    teleoperator,
    write_diagram,
)
from teleopdesign.passivity import Search, diagram_claims, hand_port, passive, two_port
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.passivity.linear_diagrams import linear_claims
from teleopdesign.passivity.ports import ports
from teleopdesign.realise.lti import S, linear_blocks

HAND = hand(mass=0.1, damping=2.0, stiffness=100.0)
QUICK = Search(tries=3)


def dahl(level, stiffness):
    return controller("dahl", {"level": level, "stiffness": stiffness})


def spring(stiffness, damping):
    return controller("spring_damper", {"stiffness": stiffness, "damping": damping})


def giving(friction=0.5, stiffness=2e4):
    """A device whose friction gives before it slides."""
    return body(0.15, friction=friction).with_effect(
        td.EFFECTS["presliding"], {"stiffness": stiffness}
    )


def checked_claims(diagram, search=QUICK):
    statuses = diagram_claims(diagram, rng=np.random.default_rng(1), search=search)
    claims = {s.topic: s.claim for s in statuses.claims}
    for claim in claims.values():
        for certificate in claim.certificates:
            certificate.check()
        if claim.status == "refuted":
            assert claim.record.replay() > 0
    return claims


def test_a_linear_haptic_interface_is_judged_exactly_and_without_its_hand():
    # Z = (m s + b)(1 + tau s)/(2 + tau s), passive iff b >= m/tau = 18.85 N s/m
    low_pass = controller("low_pass", {"bandwidth": 20.0})
    for damping, status in ((19.0, "proved"), (18.7, "refuted")):
        device = body(0.15, damping=damping)
        diagram = haptic_interface(device, hand=HAND, force_feedback=low_pass, analog=("H",))
        exact, _ = hand_port(diagram)
        claim = checked_claims(diagram)["the port, any motion"]
        assert str(exact) in claim.statement and claim.status == status


def test_the_impedances_of_a_teleoperator_are_those_of_its_symbolic_two_port():
    diagram = teleoperator(body(0.2), body(0.3), coupling=spring(300.0, 2.0))
    impedance = family_at(diagram, ports(diagram)).z
    symbolic = two_port_functions(diagram)
    values = {block_symbol(n): e for n, e in linear_blocks(diagram).blocks.items()}
    for i, row in enumerate("ms"):
        for j, column in enumerate("ms"):
            one = sp.sympify(symbolic[f"Z_{row}{column}"]).subs(values) / S
            difference = sp.lambdify(S, impedance[i, j] - one)
            # exact numbers against floats: rounding of some thousand N s/m
            assert abs(difference(2.0 + 7.0j)) < 1e-9


@pytest.mark.slow
@settings(max_examples=4)
@given(
    stiffness=st.integers(1, 2000),
    damping=st.integers(0, 20),
    masses=st.tuples(st.integers(1, 9), st.integers(1, 9)),
)
def test_masses_on_springs_and_dampers_are_always_proved_passive(stiffness, damping, masses):
    master, slave = (body(m / 10, damping=1.5) for m in masses)
    coupling = spring(float(stiffness), float(damping))
    claims = checked_claims(teleoperator(master, slave, coupling=coupling, hand=HAND))
    assert [c.status for c in claims.values()] == ["proved", "proved"]


@pytest.mark.slow
def test_a_coupling_that_leads_gives_out_energy_which_a_wave_shows():
    lead = controller("lead", {"gain": 300.0, "zero": 10.0, "pole": 1.0})
    claims = checked_claims(teleoperator(body(0.15), body(0.15), coupling=lead))
    assert {c.status for c in claims.values()} == {"refuted"}


@pytest.mark.parametrize(
    ("device", "law", "status"),
    [
        (body(0.15, friction=0.5), dahl(0.5, 1e4), "proved"),  # with equality
        (body(0.15, friction=0.5), controller("coulomb", {"level": 0.5}), "proved"),
        (body(0.15, friction=0.5), CANCELLATION, "proved"),
        (giving(), dahl(0.4, 1.5e4), "proved"),  # 1.5^2/0.4 <= 2^2/0.5
        (giving(), dahl(0.2, 1.5e4), "refuted"),
        # 4 s: the stronger law is searched to the end
        pytest.param(body(0.15, friction=0.5), dahl(0.6, 1e4), "refuted", marks=pytest.mark.slow),
    ],
)
def test_friction_with_its_cancellation_is_decided_as_for_a_diagnosed_device(device, law, status):
    claims = checked_claims(haptic_interface(device, hand=HAND, cancellation=law))
    friction = [c for t, c in claims.items() if t.startswith("friction of Z_M with C")]
    assert [c.status for c in friction] == [status]
    if status == "proved":
        assert claims["all ports, any motion"].status == "proved"
    else:
        assert claims["port (R_V, L), search by simulation"].status in ("refuted", "evidence")


def test_parts_that_are_proved_add_up_on_several_ports():
    rubbing = body(0.15, friction=0.5)
    held = teleoperator(
        rubbing,
        rubbing,
        coupling=spring(300.0, 2.0),
        hand=HAND,
        master_cancellation=dahl(0.4, 1e4),
        slave_cancellation=CANCELLATION,
    )
    for diagram in (held, two_rods()):
        claim = checked_claims(diagram)["all ports, any motion"]
        assert claim.status == "proved" and len(claim.certificates) == 3


def test_a_law_of_velocity_on_friction_that_gives_is_refuted_by_theorem_and_by_search():
    claims = checked_claims(haptic_interface(giving(), cancellation=CANCELLATION))
    assert claims["friction of Z_M with C"].status == "refuted"
    assert claims["port (R_V, L), search by simulation"].status == "refuted"


@pytest.mark.slow  # 3 s: it is searched
def test_force_feedback_is_no_sum_of_parts():
    feedback = scheduled_force_feedback(gain=3.0, scheduling_velocity=0.1, bandwidth=20.0)
    diagram = haptic_interface(
        body(0.15, friction=0.5), cancellation=CANCELLATION, force_feedback=feedback
    )
    claims = checked_claims(diagram)
    assert "all ports, any motion" not in claims
    assert "port (R_V, L), search by simulation" in claims


def test_a_compliant_device_has_its_port_at_the_tip():
    compliance = {"tip_inertia": 0.05, "stiffness": 1e4, "damping": 1.0}
    device = body(0.15).with_effect(td.EFFECTS["transmission_compliance"], compliance)
    diagram = haptic_interface(device, hand=HAND)
    assert [str(p) for p in ports(diagram)] == ["(R_V, L_tip)"]
    assert checked_claims(diagram)["the port, any motion"].status == "proved"


def test_a_block_without_values_or_a_port_is_reported():
    with pytest.raises(ModelError, match="Z_m is known by its name only"):
        checked_claims(teleoperator(hand=ANY))
    closed = haptic_interface(body(0.1))
    with pytest.raises(ModelError, match="no force from outside drives a body"):
        checked_claims(closed.__class__(closed.name, (), (), {"F": "force"}, measured=()))


def test_the_command_settles_a_diagram_from_a_file(tmp_path, capsys):
    file, out = tmp_path / "loop.toml", tmp_path / "claims.json"
    write_diagram(
        haptic_interface(body(0.15, friction=0.5), hand=HAND, cancellation=dahl(0.4, 1e4)), file
    )
    assert main(["passivity", str(file), "--json", str(out)]) == 0
    text = capsys.readouterr().out
    assert "not linear: Z_M.coulomb, C" in text
    assert "proved (in continuous time) all ports, any motion" in text
    content = json.loads(out.read_text())
    assert content["ports"] == ["(R_V, L)"] and len(content["claims"]) == 3
    assert main(["passivity", "--check", str(out)]) == 0
    assert "of 3 claims verified" in capsys.readouterr().out
    assert read_diagram(file).has("Z_H")


@pytest.mark.slow
def test_a_verdict_does_not_change_the_status_of_the_command(tmp_path, capsys):
    file = tmp_path / "loop.toml"
    lead = controller("lead", {"gain": 300.0, "zero": 10.0, "pole": 1.0})
    write_diagram(teleoperator(body(0.15), body(0.15), coupling=lead), file)
    assert main(["passivity", str(file)]) == 0
    assert "refuted   both ports, any motion" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["loop.toml"], "loop.toml: cannot be read"),
        (["teleoperator"], "Z_m is known by its name only"),
        (["loop.toml", "--dahl", "1", "1e4"], "--dahl: found beside a diagram"),
        (["loop.toml", "--stroke", "0"], "--stroke: found 0, expected more than 0"),
        (["loop.toml", "--speed", "nan"], "--speed: found nan"),
    ],
)
def test_bad_input_is_one_line_and_status_2(arguments, message, capsys):
    assert main(["passivity", *arguments]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1


GROWS, ENDS = ([1.0], [1.0, -1.0]), ([1.0, -1.0], [1.0, 1.0])


def from_tf(*ratios):
    made = [from_control(ct.tf(*r), name=f"law_{k}") for k, r in enumerate(ratios)]
    return made[0] if len(made) == 1 else made[0].then(made[1])


@pytest.mark.parametrize(
    "stages",
    [
        [from_tf(GROWS), from_tf(ENDS)],
        [from_tf(ENDS), from_tf(GROWS)],
        [from_tf(GROWS, ENDS)],
        [from_tf(([1.0, -1.0], [1.0, 0.0, -1.0]))],  # (s - 1)/((s - 1) (s + 1))
        [from_control(ct.ss(np.diag([1.0, -1.0]), [[0.0], [1.0]], [[1.0, 1.0]], [[0.0]]))],
    ],
    ids=["read by nothing", "driven by nothing", "within a law", "in one ratio", "in states"],
)
def test_what_grows_inside_is_proved_nothing_though_no_port_shows_it(stages):
    """The impedance of all of them is that of a passive spring, low-passed."""
    names = ["x", *(f"y{k}" for k in range(len(stages)))]
    controls = [Control(f"C{k}", law, names[k], names[k + 1], "x") for k, law in enumerate(stages)]
    body_alone = Moving("M", body(0.15, damping=2.0), "x", "u", {"f": 1}, "f")
    minus = Junction("u", {names[-1]: -1})
    diagram = Diagram("hidden", (body_alone, *controls), (minus,), {"f": "force"}, ())
    (one,) = linear_claims(diagram, ports(diagram))
    assert one.claim.status == "unknown" and "does not decay, at s = 1 1/s" in str(
        one.claim.verdict
    )


def test_a_coupling_with_a_delay_in_series_is_derived_with_its_exponential():
    """The same matrix as by hand: m s + b and P e^(-s T)/s."""
    late = controller("delay", {"time": 0.01})
    law = controller("proportional_derivative", {"stiffness": 200, "damping": 10, "bandwidth": 100})
    slide = td.Body("prismatic", {"inertia": 0.3}).with_effect(
        td.EFFECTS["viscous"], {"damping": 2}
    )
    coupled = teleoperator(slide, slide, coupling=late.then(law))
    z = family_at(coupled, ports(coupled)).z
    at = 3.0 + 40.0j
    corner = 2 * np.pi * 100
    link = (200 + 10 * corner * at / (at + corner)) * np.exp(-at * 0.01) / at
    expected = np.array([[0.3 * at + 2 + link, -link], [-link, 0.3 * at + 2 + link]])
    values = np.array(z.subs(S, at).evalf().tolist(), dtype=complex)
    assert values == pytest.approx(expected, rel=1e-12)
    assert passive(two_port(z.tolist())).status == "refuted"


def test_a_law_with_an_infinite_number_is_refused():
    with pytest.raises(ModelError, match="numerator_0 is infinite, expected a number"):
        from_control(ct.tf([float("inf")], [1, 1]))


@pytest.mark.parametrize("name", ["Z_H", "Z_E"])
def test_a_controller_is_judged_though_it_is_called_as_a_hand(name):
    """Left out by its name, a law that drives the motion was "proved" passive."""
    device = td.Body("prismatic", {"inertia": 0.3}).with_effect(
        td.EFFECTS["viscous"], {"damping": 2.0}
    )
    drives = controller("spring_damper", {"stiffness": 0.0, "damping": 50.0})
    blocks = (
        Moving("Z", device, "x", "u", {"f": 1.0}, "f"),
        Control(name, drives, "x", "F", "x"),
    )
    diagram = Diagram("named", blocks, (Junction("u", {"F": 1.0}),), {"f": "force"}, ())
    (one,) = diagram_claims(diagram, rng=np.random.default_rng(0)).claims
    assert one.claim.status == "refuted"


def test_a_diagram_that_is_not_linear_has_no_linear_claim():
    device = td.Body("prismatic", {"inertia": 0.3}).with_effect(
        td.EFFECTS["coulomb"], {"level": 0.4}
    )
    diagram = haptic_interface(device)
    (one,) = linear_claims(diagram, ports(diagram))
    assert one.claim.status == "unknown" and "not linear: Z_M.coulomb" in str(one.claim)


def test_an_infinite_value_is_refused_in_one_line():
    device = td.Body("prismatic", {"inertia": np.inf})
    with pytest.raises(ModelError, match="Z_M.inertia is inf: a claim needs finite numbers"):
        diagram_claims(haptic_interface(device), rng=np.random.default_rng(0))
