"""Names and sizes that few pages have."""

from base64 import b64decode
from types import SimpleNamespace

import numpy as np
import pytest

from teleopdesign.show.report.cannot_tell import _likeness
from teleopdesign.show.report.picture import picture


def test_a_name_with_two_dollar_signs_stays_as_it_is_written():
    made = picture(
        lambda f: f.add_subplot().set_title("joint $a_1$"), size=(2.0, 1.0), alt="a joint"
    )
    svg = b64decode(str(made).partition("base64,")[2].partition('"')[0]).decode()
    assert ">joint $a_1$</text>" in svg


@pytest.mark.parametrize("size", [1e-6, 1.0, 1e6])
def test_the_likeness_of_two_candidates_is_a_correlation_at_any_size(size):
    def leaves(*residual):
        return SimpleNamespace(check_residual=size * np.array(residual))

    base = leaves(0.0, 0.0, 0.0)
    one, other = (SimpleNamespace(fit=leaves(*r)) for r in ((1.0, 2.0, 0.0), (2.0, 1.0, 0.0)))
    assert _likeness(base, one, other) == pytest.approx(0.8)
    assert np.isnan(_likeness(base, one, SimpleNamespace(fit=base)))
