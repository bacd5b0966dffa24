"""The loop written by hand, on the laws of a free mass, without a compiler."""

from types import SimpleNamespace

import numpy as np
import pytest
from devices import body

from teleopdesign.diagrams import haptic_interface
from teleopdesign.realise._codegen import Generator
from teleopdesign.realise.equations import build_equations
from teleopdesign.realise.private_names import private_names
from teleopdesign.realise.program import module_source


def free_mass():
    """The module of a mass: input 0 is the force, sampled input 0 the command."""
    diagram = private_names(haptic_interface(body(2.0))).diagram
    names = {}
    exec(module_source(Generator(build_equations(diagram)).source(), jit=False), names)
    return SimpleNamespace(**names)


mass = free_mass()


def advance(force, command, *, samples=20, inner=5, period=1e-3, lag=0, reductions=()):
    """Columns over samples of a mass of 2 kg, and the reductions: (kind, column, other)."""
    memory = np.zeros(mass.ROWS)
    memory[mass.PARAMETERS] = 2.0
    h = period / inner
    half = 0.5 * h * np.arange(2 * samples * inner + 1)
    kinds, columns, others = (
        (np.array(x, dtype=int) for x in zip(*reductions, strict=True))
        if (reductions)
        else (np.zeros(0, dtype=int),) * 3
    )
    kept = mass.COLUMNS + np.arange(mass.MANY_COLUMNS)
    out, results = np.zeros((samples + 1) * len(kept)), np.zeros(len(kinds))
    mass.run(
        samples, inner, h, period, lag, np.zeros(0), 0.0, 0.0,
        np.zeros(lag // inner + 2), lag // inner + 2, np.zeros(0), np.zeros(0), 1,
        np.zeros(0), np.zeros(0), 2, False,
        np.array([force(half), 0.0 * half]), np.full((1, samples + 1), command),
        memory, kept, out, np.inf, 0, kinds, mass.COLUMNS + columns, mass.COLUMNS + others, results,
    )  # fmt: skip
    return out.reshape(samples + 1, -1).T, results


def test_a_constant_force_gives_a_parabola_to_rounding():
    columns, _ = advance(lambda t: 0.0 * t + 3.0, 1.0)
    t = 1e-3 * np.arange(21)
    np.testing.assert_allclose(columns[0], t**2, rtol=1e-13, atol=1e-18)  # (3 + 1) N, 2 kg
    np.testing.assert_allclose(columns[1], 2 * t, rtol=1e-13, atol=1e-18)


def test_the_scheme_is_of_fourth_order_in_a_force_over_time():
    """On a force over time alone it is Simpson's rule: exact for cubics, h^4 beyond."""
    cubic, _ = advance(lambda t: 8e6 * t**3, 0.0, inner=1)
    assert cubic[1, -1] == pytest.approx(1e6 * 0.02**4, rel=1e-12)
    errors = []
    for inner in (1, 2):
        columns, _ = advance(lambda t: np.sin(600.0 * t), 0.0, inner=inner)
        errors.append(abs(columns[1, -1] - (1 - np.cos(12.0)) / 1200.0))
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.1)


def test_a_command_acts_after_its_delay():
    columns, _ = advance(lambda t: 0.0 * t, 2.0, lag=7)  # 1.4 ms
    t = np.clip(1e-3 * np.arange(21) - 1.4e-3, 0.0, None)
    np.testing.assert_allclose(columns[1], t, rtol=1e-12, atol=1e-18)


def test_reductions_are_those_of_the_rows():
    """Last, largest, least, largest size, sum, sum of a product, its integral by trapezia."""
    which = [(0, 0, 0), (1, 1, 0), (2, 1, 0), (3, 1, 0), (4, 1, 0), (5, 0, 1), (6, 0, 1)]
    columns, values = advance(lambda t: np.cos(500.0 * t), 0.0, reductions=which)
    x, v = columns[:2]
    # accumulators begin at zero here: what is larger or less than the start counts
    expected = [x[-1], max(v.max(), 0.0), min(v.min(), 0.0), np.abs(v).max()]
    expected += [v.sum(), np.sum(x * v), np.trapezoid(x * v)]
    np.testing.assert_allclose(values, expected, rtol=1e-12, atol=1e-20)
