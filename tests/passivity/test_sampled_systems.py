"""Discrete systems of python-control as the law of a sampled body: the claim is that on H(z)."""

import control
import numpy as np
import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import required_damping, sampled_passivity

z = sp.Symbol("z")
PERIOD = 1e-3
#: wall of 500 N/m and 2 N s/m by the difference of two readings
WALL = 500 + 2 / sp.Rational(1, 1000) * (1 - 1 / z)
FORMS = {
    "transfer function": control.tf([2500.0, -2000.0], [1.0, 0.0], PERIOD),
    "state space": control.ss([[0.0]], [[1.0]], [[-2000.0]], [[2500.0]], PERIOD),
    "any period": control.tf([2500.0, -2000.0], [1.0, 0.0], True),
}


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("damping", [2.0, 2.25, 2.5, 9.0])
def test_the_claim_is_that_on_its_transfer_function(form, damping):
    """About the limit K T/2 + B = 2.25 N s/m of a wall."""
    known = sampled_passivity(WALL, damping=damping, sample_time=PERIOD)
    claim = sampled_passivity(FORMS[form], damping=damping, sample_time=PERIOD)
    assert (claim.status, claim.statement) == (known.status, known.statement)
    assert claim.status == ("proved" if damping >= 2.25 else "refuted")


def test_the_least_damping_is_that_of_its_transfer_function():
    for form in FORMS.values():
        assert required_damping(form, sample_time=PERIOD) == pytest.approx(2.25, rel=1e-9)


@pytest.mark.parametrize("pole", [1.25, 0.5])
def test_a_mode_that_it_does_not_show_is_refused(pole):
    """Proved by its transfer function, a constant, while a state within may grow."""
    hidden = control.ss([[pole]], [[1.0]], [[0.0]], [[100.0]], PERIOD)
    cancelled = control.tf([100.0, -100.0 * pole], [1.0, -pole], PERIOD)
    for system in (hidden, cancelled):
        with pytest.raises(ModelError, match="a mode that its transfer function does not show"):
            sampled_passivity(system, damping=5.0, sample_time=PERIOD)


@pytest.mark.parametrize(
    ("system", "words"),
    [
        (control.tf([1.0], [1.0, 2.0]), "continuous time"),
        (control.tf([1.0], [1.0, 0.0], 2e-3), "every 2 ms, the body every 1 ms"),
        (
            control.ss(np.eye(2), np.eye(2), np.eye(2), np.eye(2), PERIOD),
            "one input and one output",
        ),
        (control.nlsys(None, lambda t, x, u, p: u, inputs=1, outputs=1, dt=PERIOD), "expected a"),
    ],
)
def test_what_is_no_such_law_is_one_line(system, words):
    with pytest.raises(ModelError, match=words) as caught:
        sampled_passivity(system, damping=5.0, sample_time=PERIOD)
    assert "\n" not in str(caught.value)
