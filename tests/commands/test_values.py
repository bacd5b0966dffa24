"""A value of the command line: a number in SI, or with its unit."""

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.commands._options import value_from, value_in


def read(text, quantity="position", axis="revolute"):
    return value_from(text, quantity=quantity, axis=axis, where="--pose joint1")


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("5 mm", "m", 5e-3),
        ("0.4 N*m*s", "N*m*s/rad", 0.4),
        ("30deg/s", "rad/s", np.pi / 6),
        ("1 rad/s", "Hz", 1 / (2 * np.pi)),
        ("20 %", "1", 0.2),
        ("0.2", "N^2", 0.2),
    ],
)
def test_a_value_is_converted_into_a_stated_si_unit(text, unit, value):
    np.testing.assert_allclose(value_in(text, unit=unit, where="--value"), value, rtol=1e-15)


@pytest.mark.parametrize("text", ["", "fast", "1.2.3", "deg", "1e999", "2 N", "--1"])
def test_anything_else_is_refused_in_one_line(text):
    with pytest.raises(
        ExperimentError, match=r"^--pose joint1: found|^--pose joint1: .*unit"
    ) as error:
        read(text)
    assert "\n" not in str(error.value)
