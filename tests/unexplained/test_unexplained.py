"""What the shipped model leaves is said, with numbers, graph and formula; and by the command."""

from dataclasses import replace

import numpy as np
import pytest

from teleopdesign.diagnose.noise_floor import noise_floor
from teleopdesign.measurement.reversals import look_back_to_reversal
from teleopdesign.unexplained import describe_residual, where_it_fails
from teleopdesign.unexplained.rows import rows_of
from teleopdesign.unexplained.shapes import (
    POSITION,
    knots_of,
)


def test_the_shipped_model_needs_more_friction_at_low_speed_in_both_directions(failure):
    part, one = failure.largest
    assert one.dependence.shape.name == "friction over speed"
    assert "in both directions" in one.sentence
    assert "below 1" in one.sentence and "more than the model" in one.sentence
    (term,) = one.formula.terms
    # planted 0.2 N and 22 mm/s; the description is of first order: a tenth
    assert term.kind == "bell"
    assert term.number == pytest.approx(0.022, rel=0.1)
    assert one.formula.coefficients[0] == pytest.approx(0.2, rel=0.1)
    assert part.after < 0.3 * part.error


@pytest.mark.slow
def test_a_model_that_leaves_only_noise_is_reported_to_be_fine(rod, adequate):
    (finding,) = where_it_fails(adequate, rod)
    assert finding.concern == "fine"


@pytest.mark.slow
def test_what_is_left_is_counted_in_the_floors_that_a_diagnosis_kept_to(rod, adequate):
    floor = noise_floor(adequate.model, rod, np.random.default_rng(0))
    kept = replace(floor, value=0.25 * floor.drawn)
    assert kept.counted == pytest.approx(0.25)
    ((whole,), (part,)) = (describe_residual(adequate, rod, f).parts for f in (floor, kept))
    assert part.floor == pytest.approx(0.25 * whole.floor)
    assert whole.is_adequate and not part.is_adequate


def test_every_dependence_is_drawn(failure):
    import matplotlib.pyplot as plt

    figure = failure.plot()
    panels = [ax for ax in figure.axes if ax.axison]
    assert len(panels) == len(failure.parts[0].views) + len(failure.parts[0].dependences)
    assert "Below" in figure.get_suptitle()
    plt.close(figure)


def test_a_record_with_a_separate_zero_is_not_asked_about_position(rod, adequate):
    zero = frozenset({"position_zero"})
    zeroed = replace(rod, stretches=tuple(replace(s, offset_names=zero) for s in rod.stretches))
    rows = rows_of(adequate.model, zeroed, "device")
    assert len(knots_of(POSITION, rows)) == 0


@pytest.mark.slow
def test_without_check_records_blocks_are_held_out(rod, lacking):
    fit_records = replace(rod, stretches=rod.of("fit"))
    description = describe_residual(lacking, fit_records)
    assert description.largest[1].dependence.shape.name == "friction over speed"


def test_time_and_travel_are_counted_from_where_the_body_set_off():
    direction = np.array([0, 1, 1, 0, 0, 0, 1, 1, -1, -1], dtype=np.int8)
    x = np.array([0.0, 1, 2, 2, 2, 2, 3, 4, 3, 2])
    elapsed = look_back_to_reversal(direction, x, sample_time=0.1, rest=0.35)
    assert elapsed.known.tolist() == [False] + [True] * 9
    assert elapsed.time == pytest.approx([0, 0, 0.1, 0.2, 0.3, 0.4, 0, 0.1, 0, 0.1])
    assert elapsed.travel == pytest.approx([0, 0, 1, 1, 1, 1, 0, 1, 0, 1])
    assert elapsed.rested[6:8] == pytest.approx(0.4) and elapsed.rested[8] == pytest.approx(0.1)
    short = look_back_to_reversal(direction, x, sample_time=0.1, rest=0.5)
    assert short.time[6] == pytest.approx(0.5), "a short stop is no new start"
