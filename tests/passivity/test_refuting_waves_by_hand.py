"""Waves and terminations that refute: found where they are known to be, and nowhere else."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
import sympy as sp
from devices import body

from teleopdesign.controllers import controller
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import Coulomb, Dahl, Spring, available_storage, claim_over_intervals
from teleopdesign.passivity import two_port as two_port_of
from teleopdesign.passivity.two_port import waves
from teleopdesign.passivity.two_port.several_ports import passive_together
from teleopdesign.realise.lti import S


def taken_out(wave, at_port):
    """Whether Re Z < 0 at the wave's s, and the wave gives out energy."""
    s = complex(float(wave.rate), float(wave.frequency))
    value = complex(at_port.subs(S, sp.N(s.real) + sp.I * s.imag)) if at_port is not None else None
    return wave.energy > 0 and s.real > 0 and (value is None or value.real < 0)


def test_an_active_first_port_is_refuted_with_the_second_clamped():
    """z11 = s - 1 takes energy in: a wave of z11 alone."""
    system = two_port_of([[S - 1, 0], [0, S + 1]])
    (text, wave), *_ = waves.terminate(system, 0.1)
    assert text == "clamped" and taken_out(wave, S - 1)


def test_an_active_second_port_is_moved_itself_with_the_first_clamped():
    system = two_port_of([[S + 1, 0], [0, S - 1]])
    terminations = dict(waves.terminate(system, 0.1))
    assert set(terminations) == {"moved, port 1 clamped"}
    assert taken_out(terminations["moved, port 1 clamped"], S - 1)


@pytest.mark.parametrize("turn", [1, 2])
@pytest.mark.parametrize("factor", [1, -1])
def test_ports_that_are_passive_alone_are_refuted_by_a_held_second_one(turn, factor):
    """z12 z21 turns by j at 1 rad/s: Llewellyn asks 2 r1 r2 - Re z12 z21 > abs(z12 z21)."""
    loop = sp.Integer(16) * turn * S**2 / (S + 1) ** 2
    system = two_port_of([[S + 1, factor * loop], [factor, S + 1]])
    frequency = 1 / (2 * np.pi)
    z = system.over(np.array([frequency]))[0]
    margin = (2 * z[0, 0].real * z[1, 1].real - (z[0, 1] * z[1, 0]).real) / abs(z[0, 1] * z[1, 0])
    terminations = dict(waves.terminate(system, frequency))
    assert "clamped" not in terminations
    if margin < 1:
        (text,) = terminations
        assert (
            text.startswith("held by ")
            and text.endswith(" N s/m")
            and taken_out(terminations[text], None)
        )


@pytest.mark.parametrize("loop", [sp.Rational(1, 4), -1, 0])
def test_a_two_port_that_no_termination_unsettles_is_refuted_by_none(loop):
    system = two_port_of([[S + 1, loop], [1, S + 1]])
    for frequency in (1e-3, 0.1, 1.0, 30.0):
        assert list(waves.terminate(system, frequency)) == []
    assert list(waves.terminate_elsewhere(system)) == []


def test_a_residue_that_the_axis_does_not_show_is_refuted_beside_its_pole():
    """Dampers of 1 N s/m, and 4/s between the ports alone: no spring."""
    system = two_port_of([[1, 4 / S], [4 / S, 1]])
    (text, wave), *_ = waves.terminate_elsewhere(system)
    assert wave.energy > 0
    wave = waves.find_wave_between(system, [], [])
    assert wave is not None and wave.energy > 0
    s = complex(float(wave.rate), float(wave.frequency))
    matrix = np.array([[1, 4 / s], [4 / s, 1]])
    v = np.array(wave.velocity)
    assert (v.conj() @ (matrix + matrix.conj().T) @ v).real < 0
    assert waves.find_wave_between(two_port_of([[1, 4], [-4, 1]]), [], []) is None


@pytest.mark.slow
@pytest.mark.parametrize("narrow", [sp.Rational(1, 10), sp.Rational(1, 10**4)])
@pytest.mark.parametrize("frequency", [sp.Rational(1, 50), 1, 70])
def test_three_ports_are_refuted_however_narrow_the_dip_is(narrow, frequency):
    """At port 2 a damper of 1 less twice a resonance of that width, between dampers of 1."""
    w = frequency
    dip = 2 * narrow * w * S / (S**2 + narrow * w * S + w**2)
    for share, status in ((sp.Rational(1, 4), "proved"), (sp.Rational(3, 4), "refuted")):
        z = sp.diag(1 + S / w, 1 - 2 * share * dip / 2, 1 + w / S)
        claim = passive_together(z)
        assert claim.status == status, (share, claim)
        if status == "refuted":
            wave = claim.record
            assert wave.energy > 0 and wave.replay() > 0
            assert float(wave.frequency) == pytest.approx(float(w), rel=0.2)
            assert abs(wave.velocity[1]) > 10 * max(abs(wave.velocity[0]), abs(wave.velocity[2]))


CABLE = [Coulomb(1.0), Spring(2.0, 1e4)]


@pytest.mark.parametrize(("level", "holds"), [(0.5, True), (1.4, False), (3.5, False)])
def test_the_margin_of_a_storage_has_the_sign_of_its_verdict(level, holds):
    storage = available_storage(Dahl(level, 3e4), CABLE, points=21)
    verdict = storage.evidence()
    assert verdict.holds is holds and (verdict.margin > 0) is holds
    turned = replace(storage, gain=2 * storage.tolerance, round_trip=0.0).evidence()
    assert not turned.holds and turned.margin == pytest.approx(-storage.tolerance)
    released = replace(storage, gain=0.0, round_trip=0.3, stroke=0.01).evidence()
    assert not released.holds and released.margin == -0.3
    assert "0.01 m forth and back release 0.3 N" in released.searched


def rubbing(**more):
    device = body(0.15, viscous__damping=1.0, coulomb__level=0.5, presliding__stiffness=2e4, **more)
    law = controller("dahl", {"level": 0.3, "stiffness": 1e4})
    return haptic_interface(device, hand=body(0.5), cancellation=law)


def test_vertices_prove_nothing_of_friction_whose_other_values_are_not_in_the_conditions():
    """A bristle that damps stands in no condition on level and stiffness: evidence at points."""
    box = {"C.dahl.level": (0.2, 0.4)}
    assert claim_over_intervals(rubbing(), box).status == "proved"
    claim = claim_over_intervals(rubbing(presliding__bristle_damping=1.0), box)
    assert claim.status in ("evidence", "unknown") and "vertices decide" not in claim.how
    assert claim.status == "unknown" or claim.at_worst.holds


@pytest.mark.slow
def test_vertices_prove_nothing_where_the_linear_rest_is_not_passive_in_between():
    """A controller beside friction whose damping may drive at one end is refuted or unknown."""
    box = {"Z_M.inertia": (0.1, 0.3), "C.dahl.level": (0.2, 0.4)}
    assert claim_over_intervals(rubbing(), box).status == "proved"
    claim = claim_over_intervals(
        rubbing(), {"Z_M.viscous.damping": (0.0, 1.0), "C.dahl.level": (0.2, 0.6)}
    )
    assert claim.status != "proved" and claim.margin != claim.margin


@pytest.mark.parametrize("second", [sp.Rational(1, 5), 1, 7])
@pytest.mark.parametrize("factor", [1, -1])
@pytest.mark.parametrize("frequency", [0.05, 0.16, 2.0])
def test_the_second_port_is_held_where_the_first_resists_least(second, factor, frequency):
    """Of all reactances at port 2, by brute force; r1 - (|L| + Re L) / (2 r2) by hand."""
    w = sp.Rational(str(frequency)) * 6
    loop = 40 * second * (S / w) ** 2 / (S / w + 1) ** 2 * factor
    system = two_port_of([[S / w + 1, loop], [1, second + S / 3]])
    (text,) = (t for t, _ in waves.terminate(system, frequency) if t.startswith("held by "))
    held = sp.sympify(text.removeprefix("held by ").removesuffix(" N s/m"), locals={"s": S})
    at = 2j * np.pi * frequency
    z11, z12, z21, z22 = (complex(e.subs(S, sp.sympify(at))) for e in system.z)
    reactance = complex(held.subs(S, sp.sympify(at)))
    assert reactance.real == pytest.approx(0.0, abs=1e-9)
    least = z11.real - (abs(z12 * z21) + (z12 * z21).real) / (2 * z22.real)
    here = (z11 - z12 * z21 / (z22 + reactance)).real
    assert here == pytest.approx(least, abs=1e-6 * (1 + abs(least)))
    tangents = np.tan(np.linspace(-1.57, 1.57, 20001)) * abs(z22)
    assert here <= (z11 - z12 * z21 / (z22 + 1j * tangents)).real.min() + 1e-6


@pytest.mark.parametrize(
    ("entries", "is_taken"),
    [
        ([[1, 1], [1, 1]], False),
        ([[1, 1], [1, 1 - sp.Rational(1, 10**30)]], True),
        ([[1, 3], [-3, 1]], False),
        ([[0, 1], [-1, 0]], False),
        ([[0, 1], [1, 5]], True),
        ([[-sp.Rational(1, 10**30), 0], [0, 5]], True),
        ([[5, 0], [0, -sp.Rational(1, 10**30)]], True),
        ([[S, 2 * S], [2 * S, 4 * S]], False),
        ([[1 / S, 2 / S], [2 / S, 4 / S]], False),
        ([[1, S], [-S, 1]], True),
        ([[1 / (S - 1), 0], [0, 1]], False),
    ],
)
def test_a_matrix_takes_energy_out_where_it_is_not_positive_to_the_last_digit(entries, is_taken):
    """At s = 1 + 3/2 j: a lossless or singular matrix does not, one a hair below does."""
    at = Fraction(1), Fraction(3, 2)
    assert waves._takes_energy_out(two_port_of(entries), at) is is_taken


def test_a_matrix_takes_nothing_out_at_a_pole():
    assert not waves._takes_energy_out(two_port_of([[1 / (S - 1), 0], [0, -1]]), (Fraction(1), 0))
