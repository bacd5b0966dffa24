"""The hand-written loop in plain Python, for several simulations side by side.

Each of them has the numbers that it has alone: no place in memory is shared or swapped. What a
simulation has alone is held against mathematics in the tests of the integrator and of the kernel.
"""

import numpy as np
import pytest
from side_by_side_cases import cases_of, plain_loop, with_a_computer, with_late_signals

from teleopdesign.realise import side_by_side
from teleopdesign.realise.kernel import execute
from teleopdesign.realise.side_by_side import (
    GridRun,
    Reduction,
    execute_many,
)


@pytest.fixture(autouse=True)
def three_lanes_of_plain_python(monkeypatch):
    monkeypatch.setattr(side_by_side, "LANES", 3)
    monkeypatch.setattr(side_by_side, "loop_of", plain_loop)
    monkeypatch.setattr(side_by_side, "count_workers", lambda: 1)


SETUPS = {
    "filtered": lambda: with_a_computer(8e-3, velocity_bandwidth=60.0),
    "observer of order 3": lambda: with_a_computer(
        8e-3, velocity="observer", velocity_bandwidth=60.0
    ),
    "continuous": lambda: with_late_signals(8e-3, 1.234e-3),
}


def four_cases(setup):
    return cases_of(setup, 4)


def alone(setup, timing, row, start=None, **more):
    values = dict(zip(setup.program.layout.parameters, row, strict=True))
    arguments = {**setup.arguments(timing), "every_step": False, **more}
    return execute(setup.program, values, timing, **arguments | {"start": start or {}})


def together(setup, timing, cases, *, reductions=(), begin=0, start=None, **more):
    arguments = setup.arguments(timing)
    run = GridRun(cases, timing, arguments["inputs"], arguments["sampled"], **more)
    kept = range(len(setup.program.layout.columns))
    options = {"kept": kept, "reductions": reductions, "begin": begin, "start": start or {}}
    return execute_many(setup.program, [run], **options)[0]


@pytest.mark.parametrize("name", SETUPS)
def test_a_simulation_has_the_same_numbers_beside_others(name):
    setup = SETUPS[name]()
    timing, cases = setup.timing(setup.inner()), four_cases(setup)
    start = dict.fromkeys(setup.program.layout.states[:3], 1e-4)
    many = together(setup, timing, cases, start=start)
    assert many.is_finite.all() and np.ptp(many.kept, axis=0).any()
    for case, row in enumerate(cases):
        rows, worst = alone(setup, timing, row, start)
        size = np.abs(rows).max(axis=0)
        assert np.all(np.abs(many.kept[case] - rows) <= 1e-9 * size)
        assert many.worst[case] == pytest.approx(worst, rel=1e-9)


def test_numbers_over_time_are_those_of_the_rows_of_each_case():
    setup = SETUPS["filtered"]()
    timing, cases, begin = setup.timing(10), four_cases(setup), 3
    first, other = map(setup.program.layout.columns.index, ("F_H", "X_m_velocity"))
    kinds = {"final": 0, "maximum": 0, "minimum": 0, "peak": 0, "mean": 0, "rms": first}
    reductions = [Reduction(k, first, n) for k, n in (kinds | {"energy": other}).items()]
    many = together(setup, timing, cases, reductions=reductions, begin=begin)
    for case in range(len(cases)):
        y, v = many.kept[case, begin:, first], many.kept[case, begin:, other]
        area = timing.period * np.trapezoid(y * v)
        expected = [
            y[-1],
            y.max(),
            y.min(),
            np.abs(y).max(),
            y.mean(),
            np.sqrt(np.mean(y**2)),
            area,
        ]
        np.testing.assert_allclose(many.reduced[case], expected, rtol=1e-10)
        assert len(set(expected)) >= len(reductions) - 1


def test_a_case_beyond_all_numbers_is_reported_and_spoils_no_other():
    setup = SETUPS["continuous"]()
    timing, cases = setup.timing(setup.inner()), four_cases(setup)
    cases[2, setup.program.layout.parameters.index("M.inertia")] = 1e-300
    with np.errstate(all="ignore"):
        many = together(setup, timing, cases)
    assert many.is_finite.tolist() == [True, True, False, True]
    for case in (0, 1, 3):
        rows, _ = alone(setup, timing, cases[case])
        assert np.all(np.abs(many.kept[case] - rows) <= 1e-9 * np.abs(rows).max(axis=0))
