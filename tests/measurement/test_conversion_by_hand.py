"""What a channel's keys make of its column: factors worked out by hand, and wrong keys named."""

import math
import re

import numpy as np
import pytest

from teleopdesign.base.errors import ExperimentError
from teleopdesign.base.toml import Table
from teleopdesign.measurement.conversion import LONGEST_DELAY, conversion_of

TURN = 2 * math.pi
KIND = {"position": "position", "velocity": "velocity", "actuator_force": "force",
        "interaction_force": "force", "temperature": "temperature"}  # fmt: skip


def convert(quantity, axis, unit, **keys):
    table = Table({"column": "x", "unit": unit} | keys, "e.toml", f"channels.{quantity}")
    return conversion_of(table, quantity=quantity, kind=KIND[quantity], axis=axis, unit=unit)


def of(value, unit):
    return {"value": value, "unit": unit}


@pytest.mark.parametrize(
    ("quantity", "axis", "unit", "keys", "factor"),
    [
        ("position", "prismatic", "mm", {}, 1e-3),
        ("position", "revolute", "deg", {"sign": -1}, -math.pi / 180),
        ("position", "revolute", "deg", {"sign": 1}, math.pi / 180),
        ("position", "revolute", "counts", {"counts_per_turn": 400}, TURN / 400),
        ("position", "revolute", "counts", {"counts_per_turn": 400, "gear_ratio": 8}, TURN / 3200),
        ("position", "prismatic", "ticks", {"count": of(0.5, "um")}, 5e-7),
        ("position", "revolute", "turns", {"gear_ratio": 50}, TURN / 50),
        # on a screw: two millimetres a turn
        ("position", "prismatic", "turns", {"gear_ratio": of(500, "turn/m")}, 2e-3),
        ("velocity", "revolute", "rpm", {"gear_ratio": 10}, TURN / 600),
        ("actuator_force", "revolute", "mA", {"torque_constant": of(0.05, "N*m/A")}, 5e-5),
        ("actuator_force", "revolute", "A", {"torque_constant": of(0.05, "N*m/A"),
                                             "gear_ratio": 20, "sign": -1}, -1.0),
        ("actuator_force", "revolute", "A", {"torque_constant": of(50, "mN*m/A")}, 0.05),
        ("actuator_force", "prismatic", "V", {"torque_constant": of(12, "N/V")}, 12.0),
        ("interaction_force", "revolute", "N", {"lever_arm": of(70, "mm")}, 0.07),
        ("interaction_force", "revolute", "kN", {"lever_arm": of(2, "cm")}, 20.0),
        ("actuator_force", "revolute", "N*m", {"gear_ratio": 3}, 3.0),
        ("actuator_force", "prismatic", "N*m", {"gear_ratio": of(500, "1/m")}, 500.0),
    ],
)  # fmt: skip
def test_the_factor_to_si_is_that_of_hand_calculation(quantity, axis, unit, keys, factor):
    conversion, count = convert(quantity, axis, unit, **keys)
    assert conversion.factor == pytest.approx(factor, rel=1e-12)
    assert conversion.delay == 0.0
    assert count == (pytest.approx(abs(factor)) if unit in ("counts", "ticks") else None)
    assert conversion.signal({"x": np.array([0.0, 2.0])}) == pytest.approx([0.0, 2 * factor])


def test_columns_are_summed_with_their_scales_and_an_offset():
    conversion, count = convert(
        "position", "prismatic", "counts", column=["a", "b"], scale=[2, -0.5], offset=3,
        count=of(1, "mm"), sign=-1,
    )  # fmt: skip
    assert conversion.columns == ("a", "b")
    values = {"a": np.array([1.0, 5.0]), "b": np.array([4.0, -6.0])}
    assert conversion.signal(values) == pytest.approx([-3e-3, -16e-3])
    assert count == pytest.approx(2e-3)  # a count of the column with the largest scale
    same = convert("position", "prismatic", "m", column=["a", "b"], scale=0.5)[0]
    assert same.scales == (0.5, 0.5)
    assert same.signal(values) == pytest.approx([2.5, -0.5])
    shifted = convert("position", "prismatic", "mm", offset=-4.0)[0]
    assert shifted.signal({"x": np.array([4.0, 5.0])}) == pytest.approx([0.0, 1e-3])


@pytest.mark.parametrize(
    ("unit", "keys", "period"),
    [
        ("deg", {"unwrap": True}, 360.0),
        ("rad", {"unwrap": True}, TURN),
        ("deg", {"unwrap": True, "scale": -2.0}, 180.0),
        ("counts", {"unwrap": True, "counts_per_turn": 4096}, 4096.0),
        ("counts", {"unwrap": 65536, "counts_per_turn": 4096}, 65536.0),
        ("deg", {"unwrap": 180}, 180.0),
        ("deg", {"unwrap": False}, 0.0),
        ("deg", {}, 0.0),
    ],
)
def test_a_column_that_wraps_goes_on(unit, keys, period):
    conversion, _ = convert("position", "revolute", unit, **keys)
    assert conversion.period == pytest.approx(period)
    straight = np.linspace(0.0, 3.3 * (period or 1.0), 200)
    if not period:
        assert conversion.wraps({"x": straight}) == 0
        return
    wrapped = {"x": np.mod(straight, period)}
    assert conversion.wraps(wrapped) == 3
    scale = keys.get("scale", 1.0)
    signal = conversion.signal(wrapped)
    assert signal == pytest.approx(scale * conversion.factor * straight, abs=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_delay_is_at_most_what_the_ends_of_a_record_are_trimmed_by(sign):
    late = convert("position", "prismatic", "m", delay=of(sign * 1e3 * LONGEST_DELAY, "ms"))[0]
    assert late.delay == pytest.approx(sign * LONGEST_DELAY)
    with pytest.raises(ExperimentError, match="delay: found .* s, expected at most 0.2 s"):
        convert("position", "prismatic", "m", delay=of(sign * 0.2001, "s"))


@pytest.mark.parametrize(
    ("quantity", "axis", "unit", "keys", "message"),
    [
        ("position", "revolute", "rad", {"torque_constant": of(1, "N/A")},
         'torque_constant: found on "position" of a revolute axis'),
        ("temperature", "revolute", "degC", {"gear_ratio": 2},
         'gear_ratio: found on "temperature" of a revolute axis'),
        ("actuator_force", "revolute", "A", {"torque_constant": 0.05},
         'torque_constant: no unit, expected { value = ..., unit = "N*m/A" }'),
        ("actuator_force", "prismatic", "A", {"torque_constant": of(0, "N/A")},
         "torque_constant: found 0, expected another number"),
        ("actuator_force", "prismatic", "N", {"lever_arm": of(1, "m")},
         'lever_arm: found on "actuator_force" of a prismatic axis'),
        ("position", "revolute", "rad", {"lever_arm": of(1, "m")},
         'lever_arm: found on "position" of a revolute axis'),
        ("actuator_force", "revolute", "N", {"lever_arm": of(-70, "mm")},
         "lever_arm: found -70, expected a number above 0"),
        ("actuator_force", "revolute", "N", {}, "expected a torque, or beside a force lever_arm"),
        ("actuator_force", "revolute", "A", {}, "expected beside a current torque_constant"),
        ("position", "revolute", "rad", {"counts_per_turn": 4},
         'counts_per_turn: found with unit "rad", expected unit "counts"'),
        ("position", "revolute", "counts", {}, "expected beside it counts_per_turn = 4096"),
        ("position", "revolute", "counts", {"counts_per_turn": 4, "count": of(1, "rad")},
         "expected beside it counts_per_turn = 4096"),
        ("velocity", "revolute", "rad/s", {"unwrap": True}, "unwrap: found on a velocity"),
        ("position", "prismatic", "m", {"unwrap": True}, 'unwrap: found true with unit "m"'),
        ("position", "prismatic", "counts", {"unwrap": True, "count": of(1, "mm")},
         "unwrap: found true with counts, expected where the counter wraps"),
        ("position", "prismatic", "m", {"unwrap": 0}, "unwrap: found 0"),
        ("position", "prismatic", "m", {"sign": 2}, "sign: found 2, expected 1 or -1"),
        ("position", "prismatic", "m", {"scale": True}, "expected a number other than 0"),
        ("position", "prismatic", "m", {"scale": [1, 2]}, "found 2 numbers, expected 1, one a"),
        ("position", "prismatic", "m", {"column": ["a", "a"]}, "column: found a column twice"),
        ("position", "prismatic", "m", {"column": ["a", " "]}, "expected names of columns"),
    ],
)  # fmt: skip
def test_keys_that_do_not_suit_are_named(quantity, axis, unit, keys, message):
    with pytest.raises(ExperimentError, match=re.escape(message)) as caught:
        convert(quantity, axis, unit, **keys)
    assert str(caught.value).startswith(f"e.toml: channels.{quantity}")


def test_a_list_of_scales_is_offered_for_several_columns_alone():
    with pytest.raises(ExperimentError, match="other than 0, or a list of them$"):
        convert("position", "prismatic", "m", column=["a", "b"], scale=0)
    with pytest.raises(ExperimentError, match="other than 0$"):
        convert("position", "prismatic", "m", scale=0)
