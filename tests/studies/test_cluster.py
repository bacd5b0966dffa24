"""A study on a cluster gives the numbers of one process, also where a worker is killed."""

import numpy as np
import pytest
import study_models as models
import xarray
from study_processes import AXES

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError, ModelError


@pytest.fixture(scope="module")
def cluster():
    """A scheduler and two workers, each a process of its own."""
    distributed = pytest.importorskip("distributed")
    made = distributed.LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=True,
        dashboard_address=None,
        host="127.0.0.1",
        silence_logs=50,
    )
    yield made
    made.close(timeout=20)


@pytest.mark.slow
def test_a_cluster_gives_the_data_set_of_one_process(cluster):
    axes = {"C.dahl.level": np.linspace(0.2, 1.2, 4), "computer.delay": [0, 1.5e-4, 1e-3]}
    arguments = {"measures": ["force_error", "energy_drawn"], **models.SIMULATED}
    one = td.study(models.interface(), axes, workers=1, **arguments)
    two = td.study(models.interface(), axes, workers=2, **arguments)
    spread = td.study(models.interface(), axes, scheduler=cluster.scheduler_address, **arguments)
    xarray.testing.assert_identical(one.data, two.data)
    xarray.testing.assert_identical(one.data, spread.data)
    assert sum(one.failures.values()) == 4


@pytest.mark.slow
def test_a_worker_of_a_cluster_that_is_killed_costs_no_point(cluster, tmp_path):
    axes = {"x": np.arange(500.0), "y": 0.5, "folder": str(tmp_path)}
    arguments = {"measures": models.value, "scheduler": cluster.scheduler_address}
    dataset = td.study(models.deadly_product, axes, **arguments)
    assert (tmp_path / "killed").exists()
    np.testing.assert_array_equal(
        dataset["value"].values, [models.product(x, 0.5) for x in axes["x"]]
    )


@pytest.mark.slow
def test_a_cluster_that_does_not_answer_is_one_line():
    pytest.importorskip("distributed")
    with pytest.raises(ExperimentError, match="no scheduler answers at tcp://127.0.0.1:1"):
        td.study(models.product, AXES, measures=models.value, scheduler="tcp://127.0.0.1:1")


def test_workers_and_a_cluster_are_one_or_the_other():
    with pytest.raises(ModelError, match="a cluster has its own workers"):
        td.study(models.product, AXES, measures=models.value, scheduler="tcp://a:1", workers=2)
    with pytest.raises(ModelError, match="expected 1 or more"):
        td.study(models.product, AXES, measures=models.value, workers=0)
