"""Bad input of a study is one line before its first point, and no finished point is lost."""

import pytest
import study_models as models
import xarray

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.cli import main

AXIS = "C.dahl.level"


def value(result):
    return result


def on_interface(axes=None, measures="force_error", **changes):
    arguments = {**models.SIMULATED, "workers": 1, **changes}
    axes = {AXIS: [0.5, 1.0]} if axes is None else axes
    return td.study(models.interface(), axes, measures=measures, **arguments)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"axes": {AXIS: ["1 N", "2 N"]}}, 'found the text "1 N", expected a number'),
        ({"axes": {AXIS: "1 N"}}, 'found the text "1 N", expected a number'),
        ({"axes": {AXIS: float("nan")}}, "found the number nan"),
        ({"axes": {AXIS: {"from": 1, "to": 2}}}, "expected values in a list"),
        ({"axes": {"initial.Q": [1.0]}}, 'initial: no state "Q"'),
        ({"axes": 5}, "axes: found the number 5"),
        ({"measures": 5}, "found the number 5, expected a measure"),
        ({"measures": None}, "found None, expected a measure"),
        ({"measures": "tracking_error"}, 'measure tracking_error: no signal "X_e"'),
        ({"measures": {"a/b": "force_error"}}, 'measure "a/b": expected another name'),
        ({"measures": {"failure": "force_error"}}, "expected another name"),
        ({"measures": {AXIS: "force_error"}}, "is a parameter: name it otherwise"),
        ({"initial": {"Q": 1.0}}, 'initial: no state "Q"'),
        ({"inputs": {"Q": 1.0}}, 'no signal from outside "Q"'),
        ({"seed": -1}, "seed: found -1"),
        ({"units": {"force_error": "mN"}}, 'force_error is in N, found "mN"'),
        ({"units": {AXIS: "mN"}}, f'{AXIS} is in N, found "mN"'),
    ],
)
def test_what_is_wrong_at_every_point_is_refused(changes, text):
    with pytest.raises(ModelError, match=text):
        on_interface(**changes)


@pytest.mark.parametrize(
    ("result", "text"),
    [
        ({"a/b": 1.0}, "expected another name"),
        ({"x": 1.0}, "the name of a parameter"),
        ({"failure": 1.0}, "expected another name"),
        (xarray.DataArray([1.0], dims="x"), "the name of a parameter"),
        (xarray.DataArray(["a"], dims="q"), "found an array of <U1 over q"),
        (xarray.DataArray([1.0], {"q": ["a"]}), "over q (<U1)"),
    ],
)
def test_a_value_without_a_place_in_the_data_set_fails_its_point(result, text, tmp_path):
    """All points were computed, and then lost with an error of xarray."""

    def measured(x):
        return result if x == 1.0 else {"good": x}

    arguments = {"measures": value, "workers": 1, "out": tmp_path / "a.nc"}
    got = td.study(measured, {"x": [2.0, 1.0]}, **arguments)
    assert got["good"].values[0] == 2.0
    (reason,) = got.failures
    assert text in reason


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_point_that_ends_python_fails_alone(workers):
    axes = {"x": [1.0, 2.0, 3.0]}
    got = td.study(models.ending, axes, measures=models.value, workers=workers)
    assert got.failures == {"SystemExit: 3": 1}


def test_a_study_whose_points_all_fail_has_status_two(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    code = "STUDY = dict(model=lambda x: 1 / (x - x), axes={'x': [1, 2]}, measures={'m': abs})"
    (tmp_path / "s.py").write_text(code)
    assert main(["study", "s.py", "--workers", "1"]) == 2
    assert "2 of 2 points failed, most: ZeroDivisionError" in capsys.readouterr().out


def doubled(a):
    return 2.0 * a


def test_a_measure_without_a_return_says_so():
    """The data set was NaN at every point, and said nothing of why."""

    def peak(value):
        max(value, 0.0)  # and no return

    result = td.study(doubled, {"a": [1.0, 2.0]}, measures=peak)
    assert "2 of 2 points failed, most: measure peak: returned nothing (None)" in repr(result)
    with pytest.raises(ModelError, match=r"measure peak: returned nothing \(None\)"):
        result["peak"]
