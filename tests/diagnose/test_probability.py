"""The probability of a candidate follows from what the ladder found of it."""

import math
from dataclasses import replace

from hypothesis import given
from hypothesis import strategies as st

from teleopdesign.diagnose.criteria import CRITERIA
from teleopdesign.diagnose.free_functions import Belief
from teleopdesign.diagnose.probability import (
    CandidateEvidence,
    evidence_of,
)


class Scored:
    """A ranked candidate of which only the score is asked."""

    def __init__(self, score):
        self.score = score


EVIDENCE = CandidateEvidence(
    Scored(50.0), accepted=True, as_good=False, share=1.0, explained=0.9, left=1.0
)


#: also of candidates whose model runs away
SCORES = st.floats(-50, 500) | st.sampled_from([float("nan"), float("inf"), -float("inf")])


@given(left=st.floats(0, 100), share=st.floats(0, 1), score=SCORES)
def test_it_is_a_probability(left, share, score):
    for accepted in (True, False):
        one = replace(
            EVIDENCE, ranked=Scored(score), accepted=accepted, share=share, left=left
        ).probability()
        assert 0.0 <= one <= 1.0


def test_an_effect_is_believed_by_what_it_explains_compare_free_functions(end):
    floor = replace(end.floor, value=0.1 * end.after.check_error)
    added = end.rungs[-1].added

    def probability(rho):
        beliefs = {} if rho is None else {added.key: Belief(rho, 0.0, "velocity")}
        noisy = replace(end, floor=floor, beliefs=beliefs)
        return next(e.probability() for e in evidence_of(noisy) if e.accepted)

    values = [probability(rho) for rho in (None, -1.0, 0.5, 0.71, 0.73, 1.0, math.inf)]
    assert values == sorted(values) and values[:2] == [0.0, 0.0]
    assert values[3] < CRITERIA.named <= values[4] and values[5] == values[6]
