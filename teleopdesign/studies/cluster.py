"""Points of a study on an existing Dask cluster: its workers run the same task."""

from __future__ import annotations

import pickle
import time
from collections import deque
from collections.abc import Sequence
from functools import lru_cache
from typing import Any

from ..base.errors import ExperimentError, ModelError
from ..base.machine import one_thread
from .evaluate import StudyTask, Unit, evaluate_unit
from .fingerprint import versions
from .outcomes import PointOutcome
from .pool import Sink
from .worker_processes import pack_task

#: s: duration of a task of the cluster, long against the milliseconds of the scheduler for each
_TASK_TIME = 1.0
_MOST_IN_TASK = 1000
#: tasks for each thread that the cluster has at a time: enough to be busy, and few enough to stop
#: soon
_AHEAD = 3


def run_on_cluster(task: StudyTask, units: list[Unit], sink: Sink, address: str) -> None:
    """Evaluate points in the workers of the scheduler at an address, such as "tcp://10.0.0.1:8786".

    raises ExperimentError: no scheduler there, or no longer, no worker, dask is not installed
    raises ModelError: workers have another version of a package
    """
    try:
        from distributed import Client, as_completed
    except ImportError:
        raise ExperimentError(
            "study: a cluster needs dask: pip install 'teleopdesign[cluster]'"
        ) from None
    try:
        client = Client(address, timeout="5s", set_as_default=False)
    except (OSError, ValueError, TypeError) as error:  # TimeoutError is an OSError
        reason = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise ExperimentError(f"study: no scheduler answers at {address}: {reason}") from None
    try:
        _check_versions(client, address)
        payload = pack_task(task)
        waiting, seconds_each = deque(units), 0.0
        deaths: dict[Unit, int] = {}
        known: dict[Any, list[Unit]] = {}
        every = as_completed([], loop=client.loop)

        def fill() -> None:
            try:
                threads = max(sum(client.nthreads().values()), 1)
            except OSError:
                raise ExperimentError(
                    f"study: the scheduler at {address} answers no more; with out=, the same call "
                    "goes on where this one stopped"
                ) from None
            while waiting and len(known) < _AHEAD * threads:
                batch = _take_batch(waiting, deaths, seconds_each, threads)
                future = client.submit(_evaluate_units, payload, batch, pure=False)
                known[future.key] = batch
                every.add(future)

        fill()
        for future in every:
            batch = known.pop(future.key)
            try:  # waits also for a result that a killed worker held, until it is computed again
                outcomes, seconds = future.result()
            except Exception as error:
                failed = _put_back(batch, waiting, deaths)
                outcomes = [
                    PointOutcome(i, reason=f"{type(error).__name__} on the cluster") for i in failed
                ]
            else:
                seconds_each = seconds / len(batch)
            for outcome in outcomes:
                sink(outcome)
            fill()
    finally:
        client.close(timeout=5)


def _take_batch(
    waiting: deque[Unit], deaths: dict[Unit, int], seconds_each: float, threads: int
) -> list[Unit]:
    """Units for one task, removed from `waiting`; a unit that may end a worker goes alone."""
    size = int(_TASK_TIME / seconds_each) if seconds_each else 1
    share = -(-len(waiting) // threads)
    size = min(max(size, 1), _MOST_IN_TASK, max(share, 1), len(waiting))
    batch = [waiting.popleft() for _ in range(size)]
    if any(deaths.get(unit) for unit in batch):
        waiting.extendleft(reversed(batch[1:]))
        batch = batch[:1]
    return batch


def _put_back(batch: list[Unit], waiting: deque[Unit], deaths: dict[Unit, int]) -> Unit:
    """Let the units of a task that failed wait once more; the points that do not: one, or none."""
    for unit in batch:
        deaths[unit] = deaths.get(unit, 0) + 1
    if len(batch) > 1:
        waiting.extendleft(reversed(batch))
    elif len(batch[0]) > 1:  # its points one by one
        alone = [(index,) for index in batch[0]]
        deaths |= dict.fromkeys(alone, 1)
        waiting.extendleft(reversed(alone))
    else:
        return batch[0]
    return ()


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


def _evaluate_units(payload: bytes, batch: Sequence[Unit]) -> tuple[list[PointOutcome], float]:
    """In a worker: the outcomes of a batch, and the time that they took, s."""
    task, start = _task(payload), time.monotonic()
    with one_thread():
        outcomes = [outcome for unit in batch for outcome in evaluate_unit(task, unit)]
    return outcomes, time.monotonic() - start


@lru_cache(maxsize=4)
def _task(payload: bytes) -> StudyTask:
    task: StudyTask = pickle.loads(payload)
    return task
