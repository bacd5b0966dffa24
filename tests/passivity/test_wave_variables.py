"""Wave variables: wiring against an independent derivation, claims against random motions."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import sympy as sp
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.base.errors import ModelError
from teleopdesign.controllers import controller
from teleopdesign.derive import two_port_functions
from teleopdesign.diagrams import ANY, Junction, four_channel, load_shipped, wave_variables
from teleopdesign.effects import EFFECTS
from teleopdesign.passivity import (
    diagram_claims,
    passive,
    two_port,
    wave_claim,
)
from teleopdesign.passivity.linear.family import family_at
from teleopdesign.passivity.ports import ports

S = sp.Symbol("s")
ENTRIES = ("Z_mm", "Z_ms", "Z_sm", "Z_ss")
BLOCKS = "Z_m Z_s b_m b_s P T_1 T_2".split()
#: a mass of 0.3 kg on 2 N s/m at either side, 10 N s/m of waves
SIDE = {"viscous__damping": 2.0}
MATCHED = controller("proportional_integral", {"gain": 1.0, "rate": 40.0})


@cache
def derived():
    """Z of the shipped wiring as a function of s and of numbers for its blocks."""
    form = two_port_functions(load_shipped("wave-variables"))
    commuting = {n: sp.Symbol(n) for n in BLOCKS}

    def plain(e):
        return e.xreplace({a: commuting.get(a.name, S) for a in e.free_symbols})

    return sp.lambdify([S, *commuting.values()], [plain(form[n]) for n in ENTRIES], "numpy")


def by_hand(s, b, k, master, slave, late):
    """Force over velocity from the printed equations: waves times (2 b)^(1/2), K and B by name.

    Unknown: u_m, v_m, u_s, v_s, F_m, F_s, v_d for given velocities of master and slave.
    """
    root = np.sqrt(2 * b)
    rows = np.zeros((5, 5), dtype=complex)  # u_m, v_m, F_m, F_s, v_d
    given_velocities = np.zeros((5, 2), dtype=complex)
    rows[0, [0, 2]], given_velocities[0, 0] = (root, -1), b  # u_m = (b v + F_m)/root
    rows[1, [1, 2]], given_velocities[1, 0] = (root, 1), b  # v_m = (b v - F_m)/root
    rows[2, [0, 3, 4]] = root * late, -1, -b  # u_s = (b v_d + F_s)/root
    rows[3, [1, 3, 4]] = root / late, 1, -b  # v_s = (b v_d - F_s)/root, v_m = v_s e^(-s T)
    rows[4, [3, 4]], given_velocities[4, 1] = (1, -k), -k  # F_s = k (v_d - v)
    _, _, force_m, force_s, _ = np.linalg.solve(rows, given_velocities)
    return np.array([[master, 0], [0, slave]]) + np.array([force_m, -force_s])


values = st.floats(0.1, 10.0)


@settings(max_examples=60)
@given(b=values, gain=values, rate=values, real=st.floats(0, 3), way=values, delay=values)
def test_the_wiring_is_that_of_the_printed_equations_and_passive(b, gain, rate, real, way, delay):
    """Z + Z^H >= 0 in the closed right half plane; master and slave of 1 kg.

    1e-9 of the matrix: rounding, near resonances of the line as well.
    """
    s = real + 1j * way
    blocks = {"Z_m": s * s, "Z_s": s * s, "b_m": b * s, "b_s": b * s, "P": gain * (1 + rate / s)}
    matrix = np.array(derived()(s, *blocks.values(), delay, delay)).reshape(2, 2) / s
    late = np.exp(-s * delay)
    expected = by_hand(s, b, b * blocks["P"], s, s, late)
    size = np.abs(expected).max()
    assert np.abs(matrix - expected).max() < 1e-9 * size / abs(late) ** 2
    if abs(late) > 1e-3:
        assert np.linalg.eigvalsh(matrix + matrix.conj().T).min() > -1e-9 * size / abs(late) ** 2


def teleoperator(**arguments):
    sides = body(0.3, **SIDE, coulomb__level=0.1), body(0.3, **SIDE)
    return wave_variables(*sides, wave_impedance=10.0, coupling=MATCHED, **arguments)


def position_force(delay):
    """The same sides: the slave a spring and damper behind, its force reflected as it is."""
    values = {"stiffness": 400.0, "damping": 10.0, "bandwidth": 500.0}
    spring = controller("proportional_derivative", values)
    back = controller("gain", {"gain": 1.0})
    return four_channel(
        body(0.3, **SIDE, coulomb__level=0.1), body(0.3, **SIDE), master_control=None,
        slave_control=spring, channels={"C_1": spring, "C_2": back}, delay=delay,
    )  # fmt: skip


@pytest.mark.parametrize("delay", [0.02, {"T_1": 0.01, "T_2": 0.3}, {"T_2": 0.02}, 0.0])
def test_a_teleoperator_of_waves_is_proved_passive_whatever_its_delays(delay):
    claim = wave_claim(teleoperator(delay=delay, hand=body(0.0, spring__stiffness=50.0)))
    assert claim.status == "proved" and len(claim.certificates) == 4
    assert all(c.check() for c in claim.certificates)


@pytest.mark.slow
@pytest.mark.parametrize("delay", [0.02, {"T_1": 0.05}])
def test_claims_on_a_diagram_of_late_waves_are_those_of_the_theorem(delay):
    """Near s = 0 rounding refuted them: what two delays leave of 1/s agrees in tens of digits."""
    diagram = teleoperator(delay=delay)
    claims = diagram_claims(diagram, rng=np.random.default_rng(0)).claims
    assert [c.claim.status for c in claims] == ["proved"]
    assert claims[0].claim.statement == wave_claim(diagram).statement
    late = family_at(diagram, ports(diagram)).z
    assert {c.status for c in (passive(two_port(late.tolist())),)} <= {"unknown", "evidence"}


def test_nothing_is_proved_of_what_is_not_wired_so():
    made = teleoperator(delay=0.02)
    other = made.with_values({"b_s.spring_damper.damping": 11.0})
    loop = [Junction("W_2", {"W_1_late": 1, "F_P": -2.5}) if j.output == "W_2" else j
            for j in made.junctions]  # fmt: skip
    for diagram in (other, replace(made, junctions=tuple(loop)), position_force(0.02)):
        with pytest.raises(ModelError, match="not wired as `wave_variables` does it"):
            wave_claim(diagram)
    with pytest.raises(ModelError, match="no values|known by its name only"):
        wave_claim(wave_variables(ANY, ANY, wave_impedance=1.0, coupling=MATCHED))
    unknown = {
        "Z_s": body(0.3, viscous__damping=2.0, actuator_lag__time_constant=0.01),
        "Z_m": body(0.3, viscous__damping=2.0, hardening_spring__stiffness=10.0),
        "P": controller("proportional_integral", {"gain": -1.0, "rate": 1.0}),
    }
    for name, block in unknown.items():
        assert wave_claim(made.with_block(name, block)).status == "unknown"


def any_body(*names):
    """A body with these effects at 1.3 for each parameter, or the nearest within its bounds."""
    made = body(2.0)
    for name in names:
        bounds = EFFECTS[name].parameters.items()
        made = made.with_effect(
            EFFECTS[name], {n: max(p.lower, min(p.upper, 1.3)) for n, p in bounds}
        )
    return made


@pytest.mark.slow
@pytest.mark.parametrize(
    "beside", [("viscous",), ("coulomb",), ("added_inertia", "transmission_compliance")]
)
def test_no_effect_of_the_catalogue_is_passed_over_by_the_proof(beside):
    """Proved for what is linear at one motion, and Coulomb friction; else unknown."""
    counted = {"viscous", "coulomb", "added_inertia", "spring"}
    count = 0
    for name in sorted({*EFFECTS} - {*beside}):
        try:
            made = any_body(*beside, name)
        except ModelError:  # it needs another effect, or does not stand beside these
            continue
        count += 1
        diagram = wave_variables(made, body(0.1), wave_impedance=10.0, coupling=MATCHED)
        expected = "proved" if {*beside, name} <= counted else "unknown"
        assert wave_claim(diagram).status == expected, name
    assert count > 10
