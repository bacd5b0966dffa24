"""Two-ports: Raisbeck's and Llewellyn's criteria, exact, over frequency and with exact delay."""

from fractions import Fraction

import pytest
import sympy as sp

from teleopdesign.passivity import (
    absolutely_stable,
    passive,
    read_record,
    two_port,
    write_record,
)
from teleopdesign.passivity.search.growing_wave import value_at
from teleopdesign.realise.lti import S


def test_passive_implies_absolutely_stable_but_not_the_reverse():
    """A unilateral two-port: absolutely stable as long as abs(z12 z21) is small, never passive."""
    one_way = two_port([[S + 1, 0], [5, S + 1]])
    assert absolutely_stable(one_way).status == "proved"
    assert passive(one_way).status == "refuted"
    gyrator = two_port([[S + 1, 3], [-3, S + 1]])
    assert passive(gyrator).status == "proved"
    assert absolutely_stable(gyrator).status == "proved"


AT_ZERO = [[1, 1 / S], [1 / S, 1]]


def test_a_growing_mode_is_written_and_read_back(tmp_path):
    for z in (AT_ZERO, [[S + 1, 3], [1, S + 1]], [[1, 0], [0, -1]], [[1, 1 / (S - 1)], [0, 1]]):
        record = absolutely_stable(two_port(z)).record
        write_record(record, tmp_path / "motion.json")
        assert read_record(tmp_path / "motion.json") == record


def test_a_late_two_port_is_refuted_by_no_rounding_beside_zero():
    """What two dead times and 1/s leave at 1e-9 rad/s agrees in tens of digits: 1 N s/m stay."""
    late = sp.exp(-S / 20)
    z = [[3 + (1 - late**2) / S, -1 + late], [-1 + late, 3 + (1 - late**2) / S]]
    for rate in (1e-12, 1e-9, 1e-6):
        value = value_at(sp.ImmutableMatrix(z), Fraction(rate), Fraction(rate))
        series = 3 + 0.1 - 0.1**2 / 2 * rate * (1 + 1j)
        assert value[0, 0] == pytest.approx(series, rel=1e-9)
    assert passive(two_port(z)).status != "refuted"
