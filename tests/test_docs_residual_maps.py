"""The picture of what each effect leaves: drawn from effects and parameters that are there."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest

from teleopdesign import EFFECTS

DOCS = Path(__file__).parents[1] / "docs"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("maps", DOCS / "make_residual_maps.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_effect_that_is_drawn_has_a_value_for_each_parameter_that_it_needs(script):
    for name, values in script.VALUES.items():
        parameters = EFFECTS[name].parameters
        needed = {p for p, parameter in parameters.items() if not parameter.optional}
        assert needed <= set(values) <= set(parameters), name


def test_the_printed_table_has_the_effects_that_are_drawn(script):
    lines = script.TABLE.read_text(encoding="utf-8").splitlines()[1:]
    assert [line.split()[0] for line in lines] == list(script.VALUES)


def test_what_is_left_of_a_bias_is_the_bias_where_the_body_moves(script):
    needed = -script.force_error(None, np.zeros(len(script.motion()[0])))
    left = script.left_by("bias", needed)
    # a refit hides a part: strokes forward and backward are not quite alike (2.3 % of it)
    assert np.median(left) == pytest.approx(script.VALUES["bias"]["force"], rel=0.05)
