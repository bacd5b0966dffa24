"""The map of margins is the two-port of the diagram, point by point, and claims no more."""

from pathlib import Path

import numpy as np
import pytest
from devices import body

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.diagrams import four_channel, haptic_interface, teleoperator
from teleopdesign.passivity import diagram_claims, margin_map, sweep_margins, two_port
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.passivity.ports import ports

DAMPING, GAIN = "C_m.proportional_derivative.damping", "C_2.gain.gain"
F = np.geomspace(0.01, 100.0, 41)


def spring(stiffness, damping):
    values = {"stiffness": stiffness, "damping": damping, "bandwidth": 500.0}
    return controller("proportional_derivative", values)


def reflected(gain):
    return controller("low_pass", {"bandwidth": 30.0}).then(controller("gain", {"gain": gain}))


def lab(**channels):
    arm = body(0.3, viscous__damping=2.0)
    law = spring(200.0, 30.0)
    laws = {"C_1": spring(200.0, 0.0), "C_4": spring(200.0, 0.0), **channels}
    return four_channel(arm, arm, master_control=law, slave_control=law, channels=laws, delay=0.005)


@pytest.mark.slow
def test_each_point_is_the_two_port_of_the_diagram_at_its_values():
    """Derived once with symbols, and by the exact matrix of one diagram: rounding apart."""
    diagram = lab(C_2=reflected(0.1), C_3=reflected(0.2))
    margins = margin_map(diagram, {GAIN: [0.05, 0.3], DAMPING: [10.0, 60.0]}, frequency=F)
    for gain in (0.05, 0.3):
        at = diagram.with_values({GAIN: gain, DAMPING: 60.0})
        expected = sweep_margins(two_port(family_at(at, ports(at)).z.tolist()), F)
        here = margins.data.sel({GAIN: gain, DAMPING: 60.0})
        assert float(here["llewellyn"]) == pytest.approx(expected.llewellyn.min(), rel=1e-9)
        assert float(here["passive"]) == pytest.approx(expected.passive.min(), rel=1e-9)


def test_the_delayed_spring_has_its_known_border():
    """Springs K both ways, late by T: Llewellyn's inequality is R_m R_s >= (K sin(w T)/w)^2."""
    arm = body(0.3, viscous__damping=2.0)
    law = spring(200.0, 0.0)
    bare = four_channel(
        arm,
        arm,
        master_control=law,
        slave_control=law,
        channels={"C_1": law, "C_4": law},
        delay=0.01,
    )
    names = ("T_1.delay.time", "T_4.delay.time")
    margins = margin_map(bare, {n: [0.009, 0.011] for n in names}, frequency=F)
    both = [float(margins.data["llewellyn"][k, k]) for k in range(2)]
    assert both[0] > 0 > both[1]  # 2 N s/m against K T = 1.8 and 2.2 N s/m


def test_a_map_says_that_it_is_no_proof_and_what_it_leaves_out():
    rubbing = body(0.3, viscous__damping=2.0, coulomb__level=0.4)
    diagram = lab(C_2=reflected(0.1)).with_block("Z_m", rubbing)
    margins = margin_map(diagram, {GAIN: [0.05, 0.3], DAMPING: [10.0]}, frequency=F)
    assert "checked numerically on the axis; left out: Z_m.coulomb" in repr(margins)
    assert margins.plot().axes


@pytest.mark.slow
def test_a_late_two_port_is_never_proved():
    claims = diagram_claims(lab(), rng=np.random.default_rng(1)).claims
    assert {c.claim.status for c in claims} <= {"evidence", "refuted", "unknown"}


def test_what_is_no_map_is_reported_in_one_line():
    one = lab(C_2=reflected(0.1))
    for diagram, values, words in (
        (one, {GAIN: [0.1]}, "expected values of two blocks"),
        (one, {GAIN: [0.1], "C_2.low_pass.bandwidth": [5.0]}, "expected values of two blocks"),
        (one, {GAIN: [0.1], "C_m.stiffness": [5.0]}, 'no parameter "C_m.stiffness"'),
        (haptic_interface(body(0.1)), {"a.b": [1.0], "c.d": [1.0]}, "no teleoperator"),
    ):
        with pytest.raises(ModelError) as caught:
            margin_map(diagram, values)
        assert words in str(caught.value) and "\n" not in str(caught.value)


def test_the_page_is_as_short_as_it_says():
    page = Path(__file__).parents[2] / "docs" / "four_channel.md"
    blocks = page.read_text(encoding="utf-8").split("```{session}\n")[1:]
    lines = [
        line
        for block in blocks
        for line in block.split("```")[0].splitlines()
        if line.strip() and not line.startswith(":")
    ]
    assert 30 < len(lines) < 40


def test_a_map_of_two_masses_joined_by_a_damper_has_its_closed_form_and_counts_what_is_stable():
    """D + c [1 -1; -1 1]: stable where d1 d2 + c (d1 + d2) >= 0; passive by an eigenvalue."""
    link = controller("spring_damper", {"stiffness": 100.0, "damping": 1.0})
    diagram = teleoperator(
        body(0.2, viscous__damping=1.0), body(0.3, viscous__damping=1.0), coupling=link
    )
    dampings, links = [0.5, 1.0, 3.0], [-0.6, -0.4, -0.2, 2.0]
    margins = margin_map(
        diagram, {"Z_m.viscous.damping": dampings, "P.spring_damper.damping": links}, frequency=F
    )
    stable = [[d + c * (d + 1.0) >= 0 for c in links] for d in dampings]
    np.testing.assert_array_equal(margins.data["llewellyn"].values >= 0, stable)
    least = [
        [np.linalg.eigvalsh(np.diag([d, 1.0]) + c * np.array([[1, -1], [-1, 1]]))[0] for c in links]
        for d in dampings
    ]
    np.testing.assert_allclose(margins.data["passive"].values, least, rtol=1e-6)
    assert f"not below 0 at {np.sum(stable)} of 12 points" in repr(margins)
    assert "left out" not in repr(margins)
    assert 0 < np.sum(stable) < 12 and set(np.unique(margins.data["frequency"])) <= set(F)


def test_a_cancellation_of_friction_is_linear_at_the_speed_that_is_stated_and_at_rest_by_default():
    """0.5 tanh(v / 0.05) N has the slope 0.5/0.05 = 10 N s/m at rest; none at ten times that."""
    law = controller("smoothed_coulomb", {"level": 0.5, "smoothing_velocity": 0.05})
    arm = body(0.3, viscous__damping=12.0)
    spring_law = controller("spring_damper", {"stiffness": 100.0, "damping": 1.0})
    pair = teleoperator(arm, arm, coupling=spring_law, master_cancellation=law)
    names = {"Z_m.viscous.damping": [12.0, 13.0], "Z_s.viscous.damping": [12.0]}

    def lowest(**more):
        data = margin_map(pair, names, frequency=F, **more).data
        return data["passive"].values.ravel()

    at_rest = lowest()
    assert np.array_equal(at_rest, lowest(speed=0.0))
    fast = lowest(speed=0.5)
    assert (fast > at_rest).all()  # the damping that the cancellation takes off at rest
    assert np.diff(at_rest)[0] > 0.0
