"""Hands and environments are roles that a diagram states, at ports; names tell nothing."""

from dataclasses import replace

import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import ModelError
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
from teleopdesign.passivity import (
    claim_over_intervals,
    diagram_claims,
    margin_map,
    ports,
    sweep_margins,
    two_port,
)
from teleopdesign.passivity.linear.family import family_at
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


def statements(diagram):
    return [str(one.claim.verdict) for one in diagram_claims(diagram).claims]


@pytest.mark.parametrize(("damping", "status"), [(1.0, "proved"), (-3.0, "refuted")])
def test_a_wall_where_no_port_is_remains_a_part_whatever_its_name_and_role(damping, status):
    expected = statements(inside("wall", "part", damping))
    for name, role in (("Z_H", "hand"), ("Z_E", "environment")):
        diagram = inside(name, role, damping)
        assert holders(diagram) == {}
        claims = diagram_claims(diagram).claims
        assert claims[0].claim.status == status
        assert [str(one.claim.verdict) for one in claims] == expected


def at_port(name, role, held=None, *, axis="x"):
    """A mass that a force from outside drives, and what resists its motion."""
    resisting = Attached(name, held or hand(mass=0.1, damping=2.0, stiffness=100.0), axis, "h",
                         role=role)  # fmt: skip
    mass = Moving("M", body(0.5, viscous__damping=0.3), "x", "u", {"f": 1, "h": 1}, "f")
    return Diagram("held", (mass, resisting), (Junction("u", {}),), {"f": "force"}, ())


@pytest.mark.parametrize("name", NAMES)
def test_at_a_port_the_role_decides_and_not_the_name(name):
    felt = {role: statements(at_port(name, role)) for role in ROLES}
    assert felt["hand"] == felt["environment"] != felt["part"]
    assert felt["part"] == statements(at_port("other", "part"))


def test_an_interval_of_what_holds_a_port_is_refused_and_one_of_a_part_is_judged():
    interval = {"Z_E.viscous.damping": (1.0, 3.0)}
    assert claim_over_intervals(at_port("Z_E", "part"), interval).status == "proved"
    with pytest.raises(ModelError, match="holds a port"):
        claim_over_intervals(at_port("Z_E", "environment"), interval)


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


def test_a_map_of_margins_leaves_out_what_holds_the_ports_alone():
    plain, held = body(0.5, viscous__damping=0.3), hand(mass=0.1, damping=2.0, stiffness=100.0)
    free = teleoperator(plain, plain, coupling=SPRING)
    values = {"Z_m.viscous.damping": [0.3, 1.0], "P.spring_damper.stiffness": [100.0, 300.0]}
    made = teleoperator(plain, plain, coupling=SPRING, hand=held, environment=held)
    expected = margin_map(free, values).data
    assert margin_map(made, values).data.equals(expected)
    parts = [replace(b, role="part") if isinstance(b, Attached) else b for b in made.blocks]
    whole = replace(made, blocks=tuple(parts))
    f = np.geomspace(0.01, 1000.0, 201)
    for damping in values["Z_m.viscous.damping"]:
        there = whole.with_values({"Z_m.viscous.damping": damping})
        there = there.with_values({"P.spring_damper.stiffness": 100.0})
        margins = sweep_margins(two_port(family_at(there, ports(there)).z), f)
        margin = margin_map(whole, values, frequency=f).data.sel(
            {"Z_m.viscous.damping": damping, "P.spring_damper.stiffness": 100.0}
        )
        assert float(margin["llewellyn"]) == pytest.approx(margins.llewellyn.min(), rel=1e-9)
        assert float(margin["passive"]) == pytest.approx(margins.passive.min(), rel=1e-9)


def test_a_file_states_the_role_and_an_older_file_is_read_by_its_names(tmp_path):
    for role in ROLES:
        diagram = at_port("Z_E", role)
        write_diagram(diagram, tmp_path / "a.toml")
        assert read_diagram(tmp_path / "a.toml") == diagram
    text = (tmp_path / "a.toml").read_text().replace('role = "environment"\n', "")
    (tmp_path / "old.toml").write_text(text)
    with pytest.warns(UserWarning, match='old.toml.*Z_E.*role.*"environment"'):
        assert read_diagram(tmp_path / "old.toml") == diagram
