"""The odds of roles are those that the corpus shows, and hold for kinds of logs that it lacks."""

import tomllib

import numpy as np
import pytest
from corpus.odds import ODDS, odds_of_the_corpus


@pytest.mark.slow
def test_the_odds_are_those_of_the_corpus_and_tell_kinds_of_logs_that_are_left_out():
    written = tomllib.loads(ODDS.read_text(encoding="utf-8"))
    for role, (odds, right, count) in odds_of_the_corpus().items():
        assert count > 50
        assert right >= 0.95 * count
        for key, value in odds.items():
            # two digits are written, and a few logs more or less move odds by little
            assert abs(np.log(value / written[role][key])) < 0.1, (role, key, value)
