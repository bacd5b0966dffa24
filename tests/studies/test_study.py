"""A study's numbers are those of the functions that it calls, with units, and reasons for gaps."""

import json
import pickle

import numpy as np
import pytest
import study_models as models
import xarray

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.passivity import dahl_compensation, observe_simulation
from teleopdesign.studies import SimulatedCase, read_study


@pytest.fixture(scope="module")
def made():
    """Twelve points, four of which cannot be simulated: a delay that is no whole step."""
    return td.study(
        models.interface(),
        {
            "C.dahl.level": [0.5, 1.0],
            "computer.delay": [0, 1.5e-4, 1e-3],
            "motion.L.frequency": [4, 5],
        },
        measures={
            "force_error": "force_error",
            "hand": td.measure("peak", signal="R_M"),
            "drawn": "energy_drawn",
            "own": lambda simulation: float(simulation["R_A"].values[-1]),
        },
        units={"own": "N"},
        workers=1,
        **models.SIMULATED,
    )


def test_a_point_is_the_simulation_with_its_values(made):
    diagram = models.interface().with_values({"C.dahl.level": 0.5})
    one = td.simulate_diagram(
        diagram,
        duration=0.2,
        motion={"L": td.sine(amplitude=0.01, frequency=4.0)},
        computer=td.Sampling(delay=1e-3),
    )
    here = {"C.dahl.level": 0.5, "computer.delay": 1e-3, "motion.L.frequency": 4}
    expected = {
        "force_error": np.sqrt(np.mean(one["E"].values ** 2)),
        "hand": np.abs(one["R_M"].values).max(),
        "drawn": max(0.0, -observe_simulation(one).lowest),
        "own": one["R_A"].values[-1],
    }
    # the frequency goes through 2 pi and back: some units of the last digit
    assert {n: float(made[n].sel(here)) for n in expected} == pytest.approx(expected, rel=1e-9)


def test_units_stand_at_axes_and_measures(made):
    units = {str(n): v.attrs.get("units") for n, v in made.data.variables.items()}
    assert units == {
        "C.dahl.level": "N",
        "computer.delay": "s",
        "motion.L.frequency": "Hz",
        "force_error": "N",
        "hand": "N",
        "drawn": "J",
        "own": "N",
        "failure": None,
    }


def test_a_point_that_fails_is_nan_with_its_reason(made):
    late = made.data.sel({"computer.delay": 1.5e-4})
    assert np.isnan(late["force_error"]).all()
    ((reason, count),) = made.failures.items()
    assert count == 4 and "no whole number of steps" in reason
    assert np.isfinite(made["force_error"].sel({"computer.delay": 0.0})).all()
    assert "4 of 12 points failed" in repr(made)


def test_what_is_needed_to_compute_it_again_stands_beside_the_numbers(made):
    attrs = made.data.attrs
    assert json.loads(attrs["fixed"])["Z_M.coulomb.level"] == 1.0
    assert json.loads(attrs["versions"])["numpy"] == np.__version__
    assert {"duration", "motion", "computer"} <= set(json.loads(attrs["settings"]))
    assert attrs["seed"] == 0 and len(attrs["model_hash"]) == 16


def test_a_file_gives_the_same_study_again(made, tmp_path):
    made.to_netcdf(tmp_path / "s.nc")
    again = read_study(tmp_path / "s.nc")
    xarray.testing.assert_identical(
        again.data, made.data.assign(failure=made.data["failure"].astype(object))
    )
    assert again.failures == made.failures
    assert pickle.loads(pickle.dumps(made)) == made


def test_a_model_may_be_a_function_of_the_parameters():
    def with_level(level, ratio):
        law = {"C.dahl.level": level, "C.dahl.stiffness": ratio * level}
        return models.interface().with_values(law)

    dataset = td.study(
        with_level,
        {"level": [0.5, 1.0], "ratio": 2e4},
        measures="force_error",
        units={"level": "N"},
        **models.SIMULATED,
    )
    direct = td.study(
        models.interface(),
        {"C.dahl.level": 1.0, "C.dahl.stiffness": 2e4},
        measures="force_error",
        **models.SIMULATED,
    )
    assert float(dataset["force_error"][1]) == float(direct["force_error"])
    assert dataset["level"].attrs["units"] == "N"


def test_claims_over_a_plane_keep_status_and_margin():
    def claim(f_D, f_C):
        return dahl_compensation(
            coulomb_level=f_C, compensator_level=f_D, compensator_stiffness=1e4
        )

    dataset = td.study(claim, {"f_D": [0.5, 1.0, 1.5], "f_C": [1.0]}, measures="claim", workers=1)
    assert list(dataset["claim_status"].values[:, 0]) == ["proved", "proved", "refuted"]
    assert list(dataset["claim_holds"].values[:, 0]) == [1, 1, 0]


def test_a_measure_may_be_an_array_over_a_further_dimension():
    def spectrum(x):
        return xarray.DataArray([x, 2 * x], {"order": [1.0, 2.0]}, ("order",), attrs={"units": "N"})

    dataset = td.study(spectrum, {"x": [1.0, 3.0]}, measures={"size": models.value})
    assert dataset["size"].dims == ("x", "order")
    np.testing.assert_array_equal(dataset["size"].values, [[1, 2], [3, 6]])
    assert dataset["size"].attrs["units"] == "N"


def test_whatever_a_function_raises_is_the_reason_of_that_point_alone():
    dataset = td.study(lambda x: 1 / x, {"x": [0.0, 2.0]}, measures=models.value)
    assert dataset.failures == {"ZeroDivisionError: float division by zero": 1}
    assert float(dataset["value"][1]) == 0.5


def test_a_case_that_every_name_is_changed_in_has_these_values():
    """Whatever `names` lists can be set and is then what `value` says."""
    case = SimulatedCase(models.interface(), duration=0.2, motion=models.SIMULATED["motion"])
    for name in case.names():
        before = case.value(name)
        changed = 0.5 * before if before and np.isfinite(before) else 1e-3
        assert case.with_values({name: changed}).value(name) == pytest.approx(changed), name
        assert case.unit(name), name


def test_what_is_no_study_is_not_read_as_one(tmp_path):
    xarray.Dataset({"a": ("t", [1.0])}).to_netcdf(tmp_path / "a.nc", engine="h5netcdf")
    with pytest.raises(ExperimentError, match="holds no study"):
        read_study(tmp_path / "a.nc")
    (tmp_path / "b.nc").write_text("none")
    with pytest.raises(ExperimentError, match="no study can be read"):
        read_study(tmp_path / "b.nc")
