"""Claims about the ports of diagrams: exact, by theorem, or from a search."""

import json

import numpy as np
import pytest
import sympy as sp
from diagrams.several_axes import CANCELLATION, body, two_rods

import teleopdesign as td
from teleopdesign.blocks import hand
from teleopdesign.cli import main
from teleopdesign.controllers import controller
from teleopdesign.derive import block_symbol, two_port_functions
from teleopdesign.diagrams import (
    haptic_interface,
    read_diagram,
    teleoperator,
    write_diagram,
)
from teleopdesign.passivity import Search, diagram_claims, hand_port, ports
from teleopdesign.passivity.linear.family import family_at
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


def test_a_compliant_device_has_its_port_at_the_tip():
    compliance = {"tip_inertia": 0.05, "stiffness": 1e4, "damping": 1.0}
    device = body(0.15).with_effect(td.EFFECTS["transmission_compliance"], compliance)
    diagram = haptic_interface(device, hand=HAND)
    assert [str(p) for p in ports(diagram)] == ["(R_V, L_tip)"]
    assert checked_claims(diagram)["the port, any motion"].status == "proved"


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
