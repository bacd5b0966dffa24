"""Where and how often a study is stopped, killed or spread changes its time, never its numbers."""

import subprocess

import numpy as np
import pytest
import study_models as models
import xarray
from study_processes import AXES, EXPECTED, in_a_process, study_code, wait_for_points

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError


@pytest.mark.slow
def test_simulations_in_processes_give_the_data_set_of_one(no_process_is_left):
    """Of 512 points side by side; the measure of a user needs each simulation by itself."""
    side_by_side = {"C.dahl.level": np.linspace(0.2, 1.2, 600), "C.dahl.stiffness": [1e4, 2e4]}
    arguments = {"measures": ["force_error", "energy_drawn"], **models.SIMULATED}
    one = td.study(models.interface(), side_by_side, workers=1, **arguments)
    two = td.study(models.interface(), side_by_side, workers=2, **arguments)
    xarray.testing.assert_identical(one.data, two.data)


@pytest.mark.slow
def test_a_point_whose_process_is_killed_is_computed_again(no_process_is_left, tmp_path):
    axes = {**AXES, "folder": str(tmp_path)}
    dataset = td.study(models.deadly_product, axes, measures=models.value, workers=2)
    assert (tmp_path / "killed").exists()
    np.testing.assert_allclose(dataset["value"].values, EXPECTED, rtol=1e-15)


@pytest.mark.slow
def test_a_point_that_kills_its_process_every_time_is_a_failure_and_no_other_is(
    no_process_is_left,
):
    dataset = td.study(models.lethal_product, AXES, measures=models.value, workers=2)
    assert dataset.failures == {"its process ended twice, by signal 9": 1}
    expected = EXPECTED.copy()
    expected[3, 0] = np.nan
    np.testing.assert_allclose(dataset["value"].values, expected, rtol=1e-15)


def test_progress_says_how_many_are_done_and_ends_with_all():
    reports = []
    td.study(models.product, AXES, measures=models.value, progress=reports.append, workers=1)
    assert reports[-1].done == reports[-1].total == 30
    assert str(reports[-1]).startswith("30 of 30 points")


def test_a_file_that_holds_the_study_is_not_computed_again(tmp_path):
    out = tmp_path / "s.nc"
    first = td.study(models.product, AXES, measures=models.value, out=out)
    written = out.stat().st_mtime_ns
    again = td.study(models.product, AXES, measures=models.value, out=out)
    assert out.stat().st_mtime_ns == written
    np.testing.assert_array_equal(first["value"].values, again["value"].values)
    assert [p.name for p in tmp_path.iterdir()] == ["s.nc"]


def test_what_an_interrupted_study_has_finished_is_not_computed_again(tmp_path):
    """Every point leaves a mark when it is computed: none leaves two."""
    out, count = tmp_path / "s.nc", [0]

    def marked(x):
        count[0] += 1
        if count[0] == 7:
            raise KeyboardInterrupt
        return x

    # the same study: what the function encloses is its own, and counted before it changes
    axes = {"x": np.arange(10.0)}
    with pytest.raises(KeyboardInterrupt):
        td.study(marked, axes, measures=models.value, out=out, workers=1)
    lines = (tmp_path / "s.nc.part").read_text().splitlines()
    assert sum('"point"' in line for line in lines) == 6
    count[0] = 0
    dataset = td.study(marked, axes, measures=models.value, out=out, workers=1)
    assert count[0] == 4
    np.testing.assert_array_equal(dataset["value"].values, np.arange(10.0))
    assert [p.name for p in tmp_path.iterdir()] == ["s.nc"]


def test_a_study_that_was_stopped_before_its_file_was_written_says_what_it_kept(tmp_path):
    out, axes = tmp_path / "s.nc", {"x": np.arange(10.0), "y": 0.5}

    def stopped(progress):
        if progress.done == progress.total:
            raise KeyboardInterrupt

    settings = {"measures": models.value, "out": out, "workers": 1}
    with pytest.raises(KeyboardInterrupt):
        td.study(models.product, axes, progress=stopped, **settings)
    assert not out.exists()
    reports = []
    td.study(models.product, axes, progress=reports.append, **settings)
    assert [(r.done, r.kept) for r in reports] == [(10, 10)] and out.exists()


def damaged_journal(tmp_path, damage):
    """A study of 10 points, of which 6 stand in a journal whose last line is damaged."""
    out = tmp_path / "s.nc"

    def stopped(progress):
        if progress.done >= 6:
            raise KeyboardInterrupt

    axes = {"x": np.arange(10.0), "y": 0.5}
    from teleopdesign.studies import outcomes as module

    module._BETWEEN, before = -1.0, module._BETWEEN
    try:
        with pytest.raises(KeyboardInterrupt):
            td.study(
                models.product, axes, measures=models.value, out=out, workers=1, progress=stopped
            )
    finally:
        module._BETWEEN = before
    part = tmp_path / "s.nc.part"
    part.write_bytes(damage(part.read_bytes()))
    first = []
    dataset = td.study(
        models.product, axes, measures=models.value, out=out, workers=1, progress=first.append
    )
    return first[-1].kept, dataset


@pytest.mark.parametrize(
    ("damage", "kept"),
    [
        (lambda data: data, 6),
        (lambda data: data[:-9], 5),
        (lambda data: data[:-3] + b"9" + data[-2:], 5),  # a digit of the last line is another
        (lambda data: data + b"\0" * 4096, 6),  # a system that crashed leaves zeros
        (lambda data: b"", 0),
    ],
)
def test_a_broken_end_of_the_kept_points_is_cut_off_and_computed_again(tmp_path, damage, kept):
    kept_points, dataset = damaged_journal(tmp_path, damage)
    assert kept_points == kept
    np.testing.assert_array_equal(
        dataset["value"].values, [models.product(x, 0.5) for x in np.arange(10.0)]
    )


@pytest.mark.slow
def test_points_of_another_study_are_not_taken_up(tmp_path):
    out = tmp_path / "s.nc"
    out.with_name("s.nc.part").write_text("")
    with in_a_process(study_code(out, points=100_000), stderr=subprocess.DEVNULL) as process:
        wait_for_points(out, 5)
        process.kill()
    with pytest.raises(ExperimentError, match="holds points of another study"):
        td.study(models.product, AXES, measures=models.value, out=out)


@pytest.mark.slow
def test_two_processes_do_not_write_into_one_file(tmp_path):
    out = tmp_path / "s.nc"
    with in_a_process(study_code(out, points=100_000), stderr=subprocess.DEVNULL) as process:
        wait_for_points(out, 1)
        try:
            axes = {"x": np.arange(100_000.0), "y": 0.5}
            with pytest.raises(ExperimentError, match="another process computes this study"):
                td.study(models.slow_product, axes, measures=models.value, out=out)
        finally:
            process.kill()
