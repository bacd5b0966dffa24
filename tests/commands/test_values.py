"""A value of the command line: a number in SI, or with its unit."""

import numpy as np
import pytest

from teleopdesign.commands._values import value_from
from teleopdesign.errors import ExperimentError


def read(text, quantity="position", axis="revolute"):
    return value_from(text, quantity=quantity, axis=axis, where="--pose joint1")


@pytest.mark.parametrize(
    ("text", "value"),
    [("0.2", 0.2), (" -.5 ", -0.5), ("45deg", np.pi / 4), ("1e2 deg ", np.radians(100)), ("3.", 3)],
)
def test_a_number_with_a_unit_or_in_si_is_read(text, value):
    np.testing.assert_allclose(read(text), value, rtol=1e-15)


@pytest.mark.parametrize("text", ["", "fast", "1.2.3", "deg", "1e999", "2 N", "--1"])
def test_anything_else_is_refused_in_one_line(text):
    with pytest.raises(
        ExperimentError, match=r"^--pose joint1: found|^--pose joint1: .*unit"
    ) as error:
        read(text)
    assert "\n" not in str(error.value)
