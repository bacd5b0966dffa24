"""Parameters that records do not determine are named, and doubtful effects leave the model."""

from dataclasses import replace

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagnose.answer import answer, load_answer, write_answer
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.products import best_product
from teleopdesign.diagnose.statements import SetAside, Undetermined
from teleopdesign.effects import EFFECTS
from teleopdesign.show.diagnose.text import ladder_text


@given(power=st.floats(0.3, 3.0), noise=st.floats(1e-4, 1e-2))
def test_the_product_that_a_record_tells_is_detected(power, noise):
    """Columns that are alike up to a little: one combination is told, the other hardly."""
    rng = np.random.default_rng(1)
    one, little = rng.standard_normal(500), noise * rng.standard_normal(500)
    columns = np.column_stack([one, power * one + little])
    covariance = np.linalg.inv(columns.T @ columns)
    powers, known = best_product(columns, np.sqrt(np.diag(covariance)))
    expected = np.array([1.0, power]) / max(1.0, power)
    np.testing.assert_allclose(powers, expected, rtol=0.05)
    assert known < 0.1 * np.sqrt(np.diag(covariance)).min()


def stribeck_of(end):
    return next(r.added for r in end.rungs if r.added is not None)


def test_what_was_set_aside_or_is_undetermined_stands_in_text_and_answer(
    diagnosis, experiment, tmp_path
):
    added, gone = stribeck_of(diagnosis), Candidate(EFFECTS["backlash"], "device")
    whole = replace(
        diagnosis,
        undetermined=(Undetermined(added, "the level at rest is not told"),),
        set_aside=(SetAside(gone, 0.03, "gap = 0.1 +- 0.2 m is not told from absence"),),
    )
    text = ladder_text(whole)
    assert "not determined: the level at rest" in text
    assert "set aside: backlash at device (3.00 %): gap" in text
    content = answer(whole)
    assert content["cannot_tell"][0]["effect"] == "stribeck"
    assert content["set_aside"][0]["reason"].startswith("gap")
    write_answer(whole, tmp_path / "answer.json")
    assert load_answer(tmp_path / "answer.json", experiment=experiment) == whole
