"""An adequate model of which the records determine nothing."""

from types import SimpleNamespace

import pytest

from teleopdesign.blocks import Value
from teleopdesign.diagnose.undetermined import open_parameters_line


@pytest.mark.parametrize(
    ("values", "is_open"),
    [
        ([Value(0.0, stderr=0.4), Value(6.0, stderr=11.0)], True),
        ([Value(0.0, stderr=0.4), Value(6.0, stderr=2.9)], False),
        ([Value(2.0, fixed=True), Value(-6.0, stderr=3.0)], True),
        ([Value(2.0), Value(6.0, stderr=3.0)], False),  # an error that is unknown
        ([Value(2.0, fixed=True)], False),
    ],
)
def test_parameters_are_open_from_errors_of_half_their_values(values, is_open):
    """A robot at one speed in one direction was "model_adequate", its inertia 0.00 +- 0.44."""
    model = SimpleNamespace(parameters=dict(enumerate(values)))
    line = open_parameters_line(model)
    assert (line is not None) == is_open
    if is_open:
        assert line.startswith("records: no parameter of the model is determined")
