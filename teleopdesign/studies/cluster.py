"""Points of a study on an existing Dask cluster: its workers run the same task."""

from __future__ import annotations

import pickle
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache, partial
from typing import Any

from ..base.errors import ExperimentError, ModelError
from ..base.machine import one_thread
from .evaluate import StudyTask, Unit
from .fingerprint import versions
from .processes import evaluate_batch, pack_task
from .shared_units import BatchResult, SharedUnits, Sink, Workers

#: s: duration of a task of the cluster, long against the milliseconds of the scheduler for each
_TASK_TIME = 1.0
#: tasks for each thread that the cluster has at a time: enough to be busy, and few enough to stop
#: soon
_AHEAD = 3


def run_on_cluster(task: StudyTask, units: list[Unit], sink: Sink, address: str) -> None:
    """Evaluate points in the workers of the scheduler at an address, such as "tcp://10.0.0.1:8786".

    raises ExperimentError: no scheduler there, or no longer, no worker, dask is not installed
    raises ModelError: workers have another version of a package
    """
    SharedUnits(units, sink).run(lambda is_first: _cluster(task, address))


@contextmanager
def _cluster(task: StudyTask, address: str) -> Iterator[Workers]:
    try:
        from distributed import Client
    except ImportError:
        raise ExperimentError(
            "study: a cluster needs dask: pip install 'teleopdesign[cluster]'"
        ) from None
    try:
        client = Client(address, timeout="5s", set_as_default=False)
    except (OSError, ValueError, TypeError) as error:  # TimeoutError is an OSError
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ExperimentError(f"study: no scheduler answers at {address}: {reason}") from None

    def count_threads() -> int:
        try:
            return max(int(sum(client.nthreads().values())), 1)
        except OSError:
            raise ExperimentError(
                f"study: the scheduler at {address} answers no more; with out=, the same call "
                "goes on where this one stopped"
            ) from None

    try:
        _check_versions(client, address)
        evaluate = partial(_evaluate_packed, pack_task(task))
        executor = client.get_executor(pure=False)
        yield Workers(executor, count_threads, evaluate, _TASK_TIME, _AHEAD, " on the cluster")
    finally:
        client.close(timeout=5)


def _check_versions(client: Any, address: str) -> None:
    by_worker = client.run(versions)
    if not by_worker:
        raise ExperimentError(f"study: the scheduler at {address} has no worker")
    here = versions()
    for worker, there in by_worker.items():
        for name, version_here in here.items():
            if there.get(name) != version_here:
                raise ModelError(
                    f"study: worker {worker} has {name} {there.get(name)}, here is "
                    f"{version_here}: results could differ"
                )


def _evaluate_packed(payload: bytes, batch: list[Unit], until: float) -> BatchResult:
    """In a worker: the outcomes of a batch."""
    with one_thread():
        return evaluate_batch(_task(payload), batch, until)


@lru_cache(maxsize=4)
def _task(payload: bytes) -> StudyTask:
    task: StudyTask = pickle.loads(payload)
    return task
