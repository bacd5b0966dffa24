"""Two-ports: Raisbeck's and Llewellyn's criteria, exact, over frequency and with exact delay."""

from fractions import Fraction

import numpy as np
import pytest
import sympy as sp

from teleopdesign.passivity import (
    absolutely_stable,
    passive,
    read_record,
    sweep_margins,
    teleoperator_two_port,
    two_port,
    write_record,
)
from teleopdesign.passivity.search.growing_wave import value_at
from teleopdesign.realise.lti import S

MASTER, SLAVE = 0.2 * S + 1, 0.5 * S + 1


def coupled(**changes):
    """A spring of 1000 N/m between dampings of 1 N s/m, unless changed."""
    arguments = {"master": MASTER, "slave": SLAVE, "stiffness": 1000} | changes
    return teleoperator_two_port(**arguments)


@pytest.mark.parametrize("damping", [0, 2])
def test_a_coupling_without_delay_is_always_passive(damping):
    """Spring and damper store and lose energy: proved for both criteria."""
    for claim in (passive(coupled(damping=damping)), absolutely_stable(coupled(damping=damping))):
        assert claim.status == "proved"
        for certificate in claim.certificates:
            certificate.check()


def test_passive_implies_absolutely_stable_but_not_the_reverse():
    """A unilateral two-port: absolutely stable as long as abs(z12 z21) is small, never passive."""
    one_way = two_port([[S + 1, 0], [5, S + 1]])
    assert absolutely_stable(one_way).status == "proved"
    assert passive(one_way).status == "refuted"
    gyrator = two_port([[S + 1, 3], [-3, S + 1]])
    assert passive(gyrator).status == "proved"
    assert absolutely_stable(gyrator).status == "proved"


def test_with_delay_a_positive_margin_is_evidence_never_proof():
    claim = absolutely_stable(coupled(stiffness=900, delay=1e-3, damping=0))
    assert claim.status == "evidence"
    assert claim.holds
    assert "numerical" not in claim.verdict.searched  # said by the status itself
    assert repr(claim).startswith("evidence: ")
    assert "proved" not in repr(claim)


def test_a_reciprocal_two_port_is_passive_where_it_is_absolutely_stable():
    """With z12 = z21 both criteria are r11 r22 >= (Re z12)^2, also with equal delays each way."""
    f = np.geomspace(0.1, 1000, 200)
    margins = sweep_margins(coupled(stiffness=1250, delay=1e-3), f)
    assert np.array_equal(margins.passive >= 0, margins.llewellyn >= 0)
    assert passive(coupled(stiffness=900, delay=1e-3)).holds
    assert passive(coupled(stiffness=1100, delay=1e-3)).status == "refuted"


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
