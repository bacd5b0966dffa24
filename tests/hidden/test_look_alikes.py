"""Which effects a truth file calls indistinguishable."""

from types import SimpleNamespace

import numpy as np
import pytest
from cases import Hidden
from look_alikes import groups
from truth_effects import Scale, shape


def look_alikes(effect, explains, *, excitation="normal", hand=True, more=()):
    """Names in the group of a hidden effect when only `explains` leave what noise leaves."""
    machine = SimpleNamespace(
        axis="prismatic",
        in_model=[["coulomb", "viscous"]],
        fixed_inertia=[False],
        sensors=[hand],
        scales=[Scale(1.0, 0.1, 0.01, 12.0, 1e-6)],
    )
    values = [{"inertia": 0.1, "level": 0.3, "damping": 1.0}]
    attempts = []

    def error(changed, added, steps):
        attempts.extend(added[0])
        return 0.02 if added[0][0] in explains else 0.08

    hidden = [Hidden(e, 0, "device", shape(np.random.default_rng(1))) for e in (effect, *more)]
    classes = groups(machine, hidden, values, error=error, true=0.02, excitation=excitation)
    return [[e["effect"] for e in g] for g in classes], set(attempts)


def test_twins_cannot_be_distinguished_by_any_record():
    assert look_alikes("bias", ())[0] == [["bias", "coulomb_asymmetry"]]
    assert look_alikes("spring", (), more=["coulomb_asymmetry"])[0] == [
        ["coulomb_asymmetry", "bias"]
    ]


def test_one_of_the_family_that_explains_as_much_is_a_look_alike():
    assert look_alikes("actuator_lag", ["actuation_delay"])[0] == [
        ["actuator_lag", "actuation_delay"]
    ]
    assert look_alikes("actuator_lag", [])[0] == []


@pytest.mark.parametrize("hand", [True, False])
def test_a_poor_excitation_puts_more_effects_to_the_test(hand):
    few, many = (look_alikes("spring", (), excitation=e, hand=hand)[1] for e in ("normal", "poor"))
    assert few == {"hardening_spring"}
    assert many > {"hardening_spring", "stribeck", "actuation_delay"}
    # a gain explains any force where no measured force sets its scale; an inertia that is free
    # is in the model already
    assert ("actuator_gain" in many) == hand and "added_inertia" not in many
