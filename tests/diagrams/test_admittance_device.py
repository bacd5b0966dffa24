"""An admittance-controlled interface: what the hand feels, and when it is passive."""

import numpy as np
import pytest
from devices import body
from hypothesis import given, settings
from hypothesis import strategies as st

from teleopdesign.controllers import controller
from teleopdesign.derive import block_symbol, proved_equal, transfer
from teleopdesign.diagrams import admittance_device, load_shipped
from teleopdesign.passivity import diagram_claims
from teleopdesign.simulate import Sampling, simulate

DEVICE = body(0.5, viscous__damping=2.0)
FREQUENCY = np.geomspace(1e-2, 1e3, 4001)


def made(inertia, damping=1.0, stiffness=0.0, **arguments):
    virtual = {"inertia": inertia, "damping": damping, "stiffness": stiffness}
    loop = {"stiffness": 2000.0, "damping": 50.0, "bandwidth": 200.0}
    return admittance_device(
        arguments.pop("device", DEVICE),
        admittance=controller("virtual_admittance", virtual),
        position_loop=controller("proportional_derivative", loop),
        **arguments,
    )


def felt(s, inertia, damping, stiffness):
    """Force over velocity at the hand, from the equations by hand."""
    low = 2 * np.pi * 200.0
    loop = 2000.0 + 50.0 * s * low / (s + low)
    admittance = 1 / (inertia * s**2 + damping * s + stiffness)
    return (0.5 * s**2 + 2.0 * s + loop) / (1 + loop * admittance) / s


def test_what_the_hand_feels_is_derived_from_the_wiring():
    alone = load_shipped("admittance-device").without("Z_H")
    poles = transfer(alone, "F_h", ("X",), given="X")["X"]
    device, loop, admittance = map(block_symbol, ("Z_d", "C", "Y"))
    assert proved_equal(poles, (1 + loop * admittance) ** -1 * (device + loop))


numbers = st.floats(0.05, 4.0).map(lambda x: round(x, 2))


@pytest.mark.slow
@settings(max_examples=8)
@given(inertia=numbers, damping=numbers, stiffness=numbers)
def test_the_claim_agrees_with_the_real_part_of_what_is_felt(inertia, damping, stiffness):
    """Proved: nowhere below zero; refuted: somewhere on the axis, or between its points."""
    diagram = made(inertia, damping, stiffness)
    (one,) = diagram_claims(diagram, rng=np.random.default_rng(0)).claims
    real = felt(2j * np.pi * FREQUENCY, inertia, damping, stiffness).real
    lowest = real.min() / np.abs(real).max()
    assert one.claim.status in ("proved", "refuted")
    if one.claim.status == "proved":
        assert lowest > -1e-9  # rounding
    elif lowest > 0:
        assert lowest < 1e-3


@pytest.mark.parametrize("period", [1e-3, 2e-4])
def test_under_a_constant_force_the_device_moves_as_the_virtual_body(period):
    """1 N on 2 kg and 4 N s/m through 0.3 N of friction of the device.

    The loop holds 2000 N/m against friction, the device's own force and what it is late: 0.5 mm.
    """
    diagram = made(2.0, 4.0, device=body(0.5, viscous__damping=2.0, coulomb__level=0.3))
    simulation = simulate(
        diagram, duration=1.0, inputs={"F_u": 1.0}, computer=Sampling(period=period), jit=False,
        step=period,
    )  # fmt: skip
    t = simulation["X"]["time"].values
    expected = t / 4 - 2.0 / 16 * (1 - np.exp(-2 * t))
    assert np.abs(simulation["X"].values - expected).max() < 5e-4
    # the force is held from the first sample on: exact there, whatever the period
    assert simulation["X_d"].values[-1] == pytest.approx(expected[-1], rel=1e-9)
