"""Effects that are absent at their values are left out, whatever needs them."""

import numpy as np
import pytest
from devices import body

from teleopdesign.diagrams import haptic_interface
from teleopdesign.effects import EFFECTS
from teleopdesign.realise.simulated import without_absent
from teleopdesign.simulate import simulate


@pytest.mark.parametrize(
    "name", sorted(n for n, e in EFFECTS.items() if e.needs <= set(EFFECTS) and n != "gravity")
)
def test_an_effect_goes_with_all_that_it_needs(name):
    """Levels at zero: no order in which they go may leave one without what it needs."""
    made, names = body(0.15), [name]
    while names:
        wanted = EFFECTS[names[-1]]
        if missing := [n for n in sorted(wanted.needs) if not made.has(n)]:
            names.append(missing[0])
            continue
        names.pop()
        if not made.has(wanted.name):
            made = made.with_effect(wanted)  # at values at which it is absent
    left = without_absent(made)
    assert all(left.has(n) for e in left.effects for n in e.needs)


def test_friction_without_a_level_is_none():
    still = body(0.15, coulomb__level=0.0, presliding__stiffness=2e4, viscous__damping=0.1)
    assert [e.name for e in without_absent(still).effects] == ["viscous"]
    run = dict(duration=0.02, inputs={"R_V": 1.0}, jit=False)
    plain = simulate(haptic_interface(body(0.15, viscous__damping=0.1)), **run)
    simulation = simulate(haptic_interface(still), **run)
    np.testing.assert_array_equal(simulation["L"], plain["L"])
