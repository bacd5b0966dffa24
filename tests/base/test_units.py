import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.units import (
    AXES,
    QUANTITIES,
    converting_factor,
    si_factor,
    to_si,
)

EVERY = [(quantity, axis) for quantity in QUANTITIES for axis in AXES]
PREFIXES = {"": 1.0, "u": 1e-6, "µ": 1e-6, "m": 1e-3, "c": 1e-2, "k": 1e3, "M": 1e6}
PREFIXED = {"m": "position", "s": "time", "N": "force", "Hz": "frequency", "g": "inertia"}


@pytest.mark.parametrize(("quantity", "axis"), EVERY)
def test_every_unit_that_a_message_proposes_is_accepted(quantity, axis):
    for unit in QUANTITIES[quantity][AXES.index(axis)].units:
        assert si_factor(unit, quantity=quantity, axis=axis) > 0


@pytest.mark.parametrize(
    ("value", "unit", "quantity", "axis", "expected"),
    [
        (1.5, "mm", "position", "prismatic", 1.5e-3),
        (90, "°", "angle", "prismatic", math.pi / 2),
        (60, "rpm", "velocity", "revolute", 2 * math.pi),
        (60, "rpm", "frequency", "revolute", 1),
        (2, "min", "time", "prismatic", 120),
        (3, "mNm", "force", "revolute", 3e-3),
        (2, "g*cm^2", "inertia", "revolute", 2e-7),
        (2, "N*s^2/m", "inertia", "prismatic", 2),
        (4, "Nm/(rad/s)", "damping", "revolute", 4),
        (4, "N/(mm/s)", "damping", "prismatic", 4e3),
        (5, "N/mm", "stiffness", "prismatic", 5e3),
        (math.pi, "N*m/deg", "stiffness", "revolute", 180),
        (6, "N/mm^3", "cubic_stiffness", "prismatic", 6e9),
        (20, "%", "dimensionless", "prismatic", 0.2),
        (0.2, None, "dimensionless", "revolute", 0.2),
    ],
)
def test_a_laboratorys_unit_is_converted(value, unit, quantity, axis, expected):
    assert to_si(value, unit, quantity=quantity, axis=axis) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("unit", "quantity", "axis", "message"),
    [
        ("N", "position", "prismatic", 'x: found "N", expected a length such as "m" or "mm"'),
        (
            "mmm",
            "position",
            "prismatic",
            'x: found "mmm", expected a length such as "m" or "mm"; did you mean "mm"?',
        ),
        ("m", "position", "revolute", 'x: found "m", expected an angle such as "rad" or "deg"'),
        (None, "force", "prismatic", 'x: no unit, expected a force such as "N" or "mN"'),
    ],
)
def test_a_unit_that_does_not_fit_is_named(unit, quantity, axis, message):
    with pytest.raises(ExperimentError) as caught:
        to_si(1.0, unit, quantity=quantity, axis=axis, where="x")
    assert str(caught.value) == message


@pytest.mark.parametrize(
    "unit", ["", " ", "m*", "/m", "m//s", "m^", "m^m", "(m", "m)", "()", "m^99", "2*m", "m" * 99]
)
def test_what_is_no_unit_is_refused(unit):
    with pytest.raises(ExperimentError):
        si_factor(unit, quantity="position")


#: "Mm" and "Grad" are words of something else
OF_LENGTHS = [p for p in PREFIXES if p not in ("M", "G")]
#: not of angles and currents, either
OF_ALL = [p for p in OF_LENGTHS if p not in ("c", "d")]


@given(
    value=st.floats(-1e12, 1e12),
    symbol=st.sampled_from(list(PREFIXED)),
    prefix=st.sampled_from(OF_ALL),
)
def test_a_prefix_scales_and_its_inverse_brings_back(value, symbol, prefix):
    quantity = PREFIXED[symbol]
    plain = to_si(value, symbol, quantity=quantity)
    prefixed = to_si(value / PREFIXES[prefix], prefix + symbol, quantity=quantity)
    assert prefixed == pytest.approx(plain, rel=1e-12)


@given(
    unit=st.text() | st.text(alphabet="mkgNsradHz*/^()-123 µ·²", max_size=20),
    value=st.floats(),
    quantity=st.sampled_from(list(QUANTITIES)),
    axis=st.sampled_from(AXES),
)
def test_any_text_is_a_unit_or_refused_in_one_line(unit, value, quantity, axis):
    try:
        assert math.isfinite(to_si(value, unit, quantity=quantity, axis=axis, where="here"))
    except ExperimentError as error:
        assert str(error).isprintable()
        assert str(error).startswith("here: ")


@pytest.mark.parametrize(
    ("unit", "rad_per_s"),
    [
        ("Hz", 2 * math.pi),
        ("kHz", 2000 * math.pi),
        ("1/s", 1.0),
        ("rad/s", 1.0),
        ("rev/s", 2 * math.pi),
    ],
)
def test_a_speed_of_rotation_in_hertz_counts_turns(unit, rad_per_s):
    assert si_factor(unit, quantity="velocity", axis="revolute") == pytest.approx(rad_per_s)
    factor = converting_factor(unit, None, quantity="velocity", axis="revolute")
    assert factor == pytest.approx(rad_per_s)
