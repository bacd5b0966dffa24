"""Intervals of estimates hold the truth as often as they say, on loggers that are off as well."""

import numpy as np
import pytest
from diagnose.simulated_cases import truth_of, write_simulated
from diagnose.test_record_shift import shifted

import teleopdesign as td

#: cases, and seed of the first: drawn once, not chosen for their answers
CASES, SEED = 8, 7000
#: rows by which the command of each case in turn is written late
ROWS = (0.0, 1.0, 0.0, -1.0)


@pytest.mark.slow
def test_ninety_five_percent_intervals_hold_nearly_that_part_of_the_truth(tmp_path):
    misses, widths = [], []
    for k in range(CASES):
        folder = write_simulated(tmp_path / str(k), None, seed=SEED + k)
        experiment = td.load_experiment(folder)
        if ROWS[k % len(ROWS)]:
            experiment = shifted(experiment, ROWS[k % len(ROWS)])
        model = td.fit(td.Model.from_experiment(experiment), experiment)
        for name, true in truth_of(folder)["model_parameters"].items():
            value = model.parameters[name]
            if value.fixed or true == 0.0:
                continue
            misses.append((value.value - true) / value.stderr)
            widths.append(value.stderr / abs(true))
    inside = np.abs(misses) < 1.96
    # 35 or so that are not independent: 95 % scatter by 4, and the method is good to a few more
    assert inside.mean() >= 0.85
    # nor are they held by intervals that say nothing
    assert np.median(widths) < 0.01
    assert np.median(np.abs(misses)) > 0.3
