"""A refutation does not depend on the last digits of floats, and its motion can be replayed."""

import control
import numpy as np
import pytest
import sympy as sp
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.controllers import from_control
from teleopdesign.diagrams import haptic_interface
from teleopdesign.passivity import (
    diagram_claims,
    positive_real,
    sampled_passivity,
)

MASS, DAMPING = 0.15, 2.0
BANDWIDTHS = (1, 10, 100)  # Hz


def observer(bandwidth, as_matrices=False):
    """A disturbance observer: it feeds back Q/(1 - Q) of the inverse plant, by control's floats."""
    s, tau = control.tf("s"), 1 / (2 * np.pi * bandwidth)
    q = 1 / (tau * s + 1) ** 2
    law = -(MASS * s + DAMPING) * s * q / (1 - q)
    return from_control(control.ss(law) if as_matrices else law)


def observed(bandwidth):
    """Z = m s + b + (m s + b)/(s tau (tau s + 2)), at low frequency Re Z = b + m/(2 tau) - b/4."""
    device = body(MASS, viscous__damping=DAMPING)
    return haptic_interface(device, cancellation=observer(bandwidth), analog=("C",))


def claims(diagram):
    return [s.claim for s in diagram_claims(diagram, rng=np.random.default_rng(0)).claims]


@pytest.mark.slow
@pytest.mark.parametrize("bandwidth", BANDWIDTHS)
def test_a_disturbance_observer_of_a_transfer_function_is_not_refuted_by_rounding(bandwidth):
    """Its s over s is no part of the transfer function, but a mode at 0 that no port shows."""
    first, *others = claims(observed(bandwidth))
    assert first.status == "unknown" and "does not decay, at s = 0" in str(first)
    assert all(other.status == "evidence" for other in others)


@pytest.mark.slow
@pytest.mark.parametrize("bandwidth", BANDWIDTHS)
def test_matrices_rounded_by_python_control_refute_nothing(bandwidth):
    """control.ss of the same law leaves a pole beside zero: proved or unknown, never refuted."""
    device = body(MASS, viscous__damping=DAMPING)
    diagram = haptic_interface(device, cancellation=observer(bandwidth, True), analog=("C",))
    assert all(claim.status != "refuted" for claim in claims(diagram))


@pytest.mark.slow
@settings(max_examples=12)  # each a proof of its own; `attacks/test_one_ports.py` has hundreds
@given(
    poles=st.lists(st.floats(0.01, 1e4), min_size=1, max_size=4),
    powers=st.tuples(st.integers(-3, 3), st.integers(-3, 3)),
)
def test_a_passive_network_through_floats_is_never_refuted(poles, powers):
    """A sum of r s/(s + p) and r/s, put together by control, is passive whatever the rounding."""
    s = control.tf("s")
    whole = 10.0 ** powers[0] / s + 10.0 ** powers[1] * s
    for k, pole in enumerate(poles):
        whole = whole + (1 + k) * s / (s + pole)
    assert positive_real(whole).status != "refuted"


@pytest.mark.slow
def test_a_wave_whose_energy_is_lost_in_the_rounding_of_its_replay_refutes_nothing():
    """A mass and a decaying pole of order 4: Re Z is 1e-25 of abs(Z) where it is negative."""
    s = sp.Symbol("s")
    above = (2000, "18/25", "61/625000", "747/125000000000", "15067/100000000000000000",
             "233295/200000000000000000000000", "6561/250000000000000000000000000")  # fmt: skip
    below = (1, "9/25000", "243/5000000000", "729/250000000000000", "6561/100000000000000000000", 0)
    p, q = (sp.Poly([sp.Rational(c) for c in row], s) for row in (above, below))
    claim = positive_real(p.as_expr() / q.as_expr())
    assert claim.status == "unknown" and "no refutation" in str(claim.verdict)


def test_a_sampled_law_that_leaves_double_precision_is_refuted_by_a_shorter_motion():
    """A pole at z = 2, nearly cancelled: over 270 000 samples it overflows."""
    z = sp.Symbol("z")
    law = (15000 * z - 30003) / (100 * z - 200)
    claim = sampled_passivity(law, damping=0.0075, sample_time=0.0001)
    assert claim.status == "refuted" and claim.record.replay() > 0
