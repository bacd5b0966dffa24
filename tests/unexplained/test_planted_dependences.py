"""What is planted in a residual is said at its size; where nothing is planted, nothing is said."""

from dataclasses import replace

import numpy as np
import pytest
from unexplained.planting import planted, sentence_on

from teleopdesign.unexplained.curve import curve_of
from teleopdesign.unexplained.dependence import dependences
from teleopdesign.unexplained.rows import rows_of
from teleopdesign.unexplained.shapes import (
    FORCE,
)


def position(a):
    return a.signals["position"]


PLANTED = {
    "force over position": (
        lambda a: a.signals["push"] * 4.0 * position(a),
        "at positions above",
        4.0,
    ),
    "friction over load": (
        lambda a: a.signals["grip"] * 0.08 * a.signals["load"],
        "command's size",
        0.08,
    ),
    "damping over position": (
        lambda a: a.signals["push"] * 3e3 * position(a) ** 2 * a.signals["velocity"],
        "more damping",
        3e3,
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", PLANTED)
def test_a_planted_dependence_is_reported_with_variable_range_and_size(rows, floor_squares, name):
    missing, words, size = PLANTED[name]
    here = planted(rows, missing)
    shapes, _ = dependences(here, floor_squares)
    assert shapes[0].shape.name == name
    text, formula = sentence_on(here, shapes[0])
    assert words in text
    assert formula.terms[0].kind in ("power", "above")
    # noise of the sensors is a tenth to a third of what is planted
    assert formula.coefficients[0] == pytest.approx(size, rel=0.15)


@pytest.mark.parametrize(
    ("name", "missing", "size"),
    [
        pytest.param("force", lambda a: a.signals["push"] * -0.06, -0.06, marks=pytest.mark.slow),
        pytest.param(
            "friction over time",
            lambda a: a.signals["grip"] * 0.2 * np.exp(-a.signals["time"] / 3.0),
            None,
            marks=pytest.mark.slow,
        ),
        ("lateness", lambda a: a.signals["push"] * 1.5e-3 * a.signals["force_rate"], 1.5e-3),
        pytest.param(
            "mass",
            lambda a: a.signals["push"] * 0.02 * a.signals["acceleration"],
            0.02,
            marks=pytest.mark.slow,
        ),
    ],
)
def test_a_planted_constant_has_its_sign_and_size(
    rod, adequate, floor_squares, name, missing, size
):
    fixed = adequate.model.parameters["device.inertia"]
    model = adequate.model.with_values({"device.inertia": replace(fixed, fixed=True)})
    here = planted(rows_of(model, rod, "device"), missing)
    shapes, _ = dependences(here, floor_squares)
    assert shapes[0].shape.name == name
    if size is not None:
        assert curve_of(here, shapes[0]).y[0] == pytest.approx(size, rel=0.1)


@pytest.mark.slow
@pytest.mark.parametrize("frequency", [0.3, 50.0])
def test_a_hum_is_detected_at_its_frequency(rows, floor_squares, frequency):
    here = planted(
        rows,
        lambda a: (
            a.signals["push"] * 0.15 * np.sin(2 * np.pi * frequency * a.signals["time"] + 1.0)
        ),
    )
    shapes, _ = dependences(here, floor_squares)
    assert shapes[0].shape.carrier is FORCE and shapes[0].shape.variable.name == "time"
    text, formula = sentence_on(here, shapes[0])
    # a tenth of the resolution of a record of 12 s
    assert formula.terms[0].number == pytest.approx(frequency, abs=0.01)
    assert np.hypot(*formula.coefficients) == pytest.approx(0.15, rel=0.1)
    assert "goes up and down at" in text


@pytest.mark.slow
def test_only_one_direction_is_reported(rows, floor_squares):
    here = planted(
        rows,
        lambda a: (
            a.signals["push"] * np.where(a.signals["velocity"] > 0, a.signals["velocity"], 0.0)
        ),
    )
    shapes, _ = dependences(here, floor_squares)
    assert shapes[0].shape.name in (
        "force over speed",
        "force over velocity",
        "friction over speed",
    )
    assert "forward" in sentence_on(here, shapes[0])[0]


@pytest.mark.slow
def test_the_residual_in_another_unit_says_the_same(rows, floor_squares):
    missing = PLANTED["force over position"][0]
    one = planted(rows, missing)
    scaled = replace(one, residual=1e3 * one.residual, measured=1e3 * one.measured)
    a, b = dependences(one, floor_squares)[0], dependences(scaled, 1e6 * floor_squares)[0]
    assert [d.shape for d in a] == [d.shape for d in b]
    assert [d.score for d in a] == pytest.approx([d.score for d in b], rel=1e-3)


@pytest.mark.slow
def test_what_another_value_of_a_parameter_explains_is_not_missing(rows, floor_squares):
    step = 0.05 * rows.tangents / np.linalg.norm(rows.tangents, axis=0)
    moved = replace(rows, residual=rows.residual + step @ np.ones(rows.tangents.shape[1]))
    assert dependences(moved, floor_squares)[0] == ()


@pytest.mark.slow
def test_nothing_is_learnt_from_the_checked_rows(rows, floor_squares):
    """A force on the check record alone is no dependence that the fit record tells of."""
    here = planted(
        rows, lambda a: a.signals["push"] * 4.0 * position(a) * (a.stretch.use == "check")
    )
    assert "force over position" not in [d.shape.name for d in dependences(here, floor_squares)[0]]


@pytest.mark.slow
def test_noise_alone_is_called_a_dependence_in_none_of_sixteen_records(rows, floor_squares):
    """Residuals of the sensors' own spectrum, drawn anew; one of a hundred may be called one."""
    rng, alarms, draws = np.random.default_rng(8), 0, 16
    size = np.sqrt(np.mean(rows.residual**2))
    for _ in range(draws):
        noise = rows.lowpassed(lambda a: rng.standard_normal((1, len(a.signals["push"]))))[:, 0]
        here = replace(rows, residual=size * noise / np.std(noise))
        alarms += bool(dependences(here, floor_squares)[0])
    assert alarms == 0
