"""Hands and environments are roles that a diagram states, at ports; names tell nothing."""

import pytest
from devices import body

from teleopdesign.blocks import MatrixImpedance, hand
from teleopdesign.controllers import controller
from teleopdesign.diagrams import (
    Attached,
    Control,
    Diagram,
    Junction,
    Linked,
    Moving,
    four_channel,
    haptic_interface,
    read_diagram,
    teleoperator,
    write_diagram,
)
from teleopdesign.passivity import claim_over_intervals, diagram_claims
from teleopdesign.passivity.ports import holders

SPRING = controller("spring_damper", {"stiffness": 300.0, "damping": 1.0})
NAMES = ("wall", "Z_E", "Z_H")
ROLES = ("part", "hand", "environment")


def inside(name, role, damping):
    """Two masses in series: a force from outside drives one, a wall resists the other."""
    wall = MatrixImpedance(((0.0,),), ((damping,),), ((20.0,),))
    blocks = (
        Moving("M", body(0.5, viscous__damping=0.3), "x", "u", {"f": 1}, "f"),
        Moving("N", body(0.5, viscous__damping=0.3), "y", "c", {"w": 1}, "c"),
        Control("P", SPRING, "e", "c", "e", analog=True),
        Linked(name, wall, ("y",), ("w",), role=role),
    )
    sums = (Junction("e", {"x": 1, "y": -1}), Junction("u", {"c": -1}))
    return Diagram("inside", blocks, sums, {"f": "force"}, ())


@pytest.mark.parametrize(("damping", "status"), [(1.0, "proved"), (-3.0, "refuted")])
def test_a_wall_where_no_port_is_remains_a_part_whatever_its_name_and_role(damping, status):
    for name, role in zip(NAMES, ROLES, strict=True):
        diagram = inside(name, role, damping)
        assert holders(diagram) == {}
        (one,) = diagram_claims(diagram).claims[:1]
        assert one.claim.status == status


def at_port(name, role, held=None, *, axis="x"):
    """A mass that a force from outside drives, and what resists its motion."""
    resisting = Attached(name, held or hand(mass=0.1, damping=2.0, stiffness=100.0), axis, "h",
                         role=role)  # fmt: skip
    mass = Moving("M", body(0.5, viscous__damping=0.3), "x", "u", {"f": 1, "h": 1}, "f")
    return Diagram("held", (mass, resisting), (Junction("u", {}),), {"f": "force"}, ())


def test_what_the_package_wires_states_its_roles():
    held = hand(mass=0.1, damping=2.0, stiffness=100.0)
    plain = body(0.5, viscous__damping=0.3)
    for diagram, expected in (
        (haptic_interface(plain, hand=held), {"Z_H": ("R_V",)}),
        (
            teleoperator(plain, plain, coupling=SPRING, hand=held, environment=held),
            {"Z_H": ("F_u",), "Z_E": ("F_d",)},
        ),
        (
            four_channel(plain, plain, hand=held, environment=held),
            {"Z_H": ("F_u",), "Z_E": ("F_d",)},
        ),
    ):
        assert holders(diagram) == expected


def test_a_hand_behind_a_compliant_transmission_holds_the_port_of_the_tip():
    from teleopdesign import EFFECTS

    soft = {"tip_inertia": 0.1, "stiffness": 4e3, "damping": 1.0}
    device = body(0.5).with_effect(EFFECTS["transmission_compliance"], soft)
    held = haptic_interface(device, hand=hand(mass=0.1, damping=2.0, stiffness=100.0))
    assert holders(held) == {"Z_H": ("R_V",)}


def test_a_file_states_the_role_and_an_older_file_is_read_by_its_names(tmp_path):
    for role in ROLES:
        diagram = at_port("Z_E", role)
        write_diagram(diagram, tmp_path / "a.toml")
        assert read_diagram(tmp_path / "a.toml") == diagram
    text = (tmp_path / "a.toml").read_text().replace('role = "environment"\n', "")
    (tmp_path / "old.toml").write_text(text)
    with pytest.warns(UserWarning, match='old.toml.*Z_E.*role.*"environment"'):
        assert read_diagram(tmp_path / "old.toml") == diagram


@pytest.mark.parametrize(("read", "holds"), [("total", True), ("h", False)])
def test_a_hand_holds_a_port_where_what_is_read_of_its_force_is_read_of_the_port(read, holds):
    """A law pushes on with twice what it reads: of the port nothing if the hand's force alone."""
    held = at_port("Z_H", "hand")
    law = Control("C", controller("gain", {"gain": 2.0}), read, "y")
    sums = (Junction("total", {"f": 1.0, "h": 1.0}), Junction("u", {"y": -1.0}))
    diagram = Diagram("read", (*held.blocks, law), sums, {"f": "force"}, ())
    assert bool(holders(diagram)) is holds
    assert claim_over_intervals(diagram, {}, claim="stable").status == "refuted"
    assert diagram_claims(diagram).claims[0].claim.status == "refuted"
