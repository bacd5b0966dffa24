"""Of which experiment an answer is: title, records, and a digest of all that was read of them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...measurement.experiment import Experiment


def experiment_data(experiment: Experiment) -> dict[str, Any]:
    """Title, axes, records with their samples, and the digest of their readings."""
    return {
        "title": experiment.title,
        "axes": {name: body.axis for name, body in experiment.bodies.items()},
        "records": [
            {"file": r.file, "use": r.use, "samples": len(r.time)} for r in experiment.records
        ],
        "digest": digest(experiment),
    }


def digest(experiment: Experiment) -> str:
    """SHA-256 of every record as it was read: use, clock and signals in SI, by their names.

    How a file is packed does not count, a unit, sign or column that is read otherwise does.
    """
    whole = hashlib.sha256()
    for r in experiment.records:
        cuts = [(s.start, s.stop) for s in r.segments]
        whole.update(repr((r.file, r.use, sorted(r.own), r.sample_time, cuts)).encode())
        for name in sorted(r.signals):
            whole.update(f"{name} {len(r.signals[name])} ".encode())
            whole.update(np.ascontiguousarray(r.signals[name], dtype="<f8").tobytes())
    return whole.hexdigest()


def difference(told: Mapping[str, Any], experiment: Experiment) -> str | None:
    """How the experiment that was told of differs from this one, in words; None where it is it."""
    found = experiment_data(experiment)
    for key, words in (("title", "title"), ("axes", "bodies"), ("records", "records")):
        if told[key] != found[key]:
            return f"{words} {_short(told[key])}, found {_short(found[key])}"
    if told["digest"] != found["digest"]:
        return "records of the same names, but they read differently now"
    return None


def bodies_text(axes: Mapping[str, str]) -> str:
    """Bodies by name with their axes: "device (prismatic)"."""
    return ", ".join(f"{place} ({axis})" for place, axis in axes.items())


def _short(told: Any) -> str:
    if isinstance(told, str):
        return f'"{told}"' if len(told) <= 60 else f'"{told[:57]}..."'
    if isinstance(told, Mapping):
        return bodies_text(told)
    listed = [f"{r['file']} ({r['use']}, {r['samples']} samples)" for r in told]
    return ", ".join(listed[:4]) + (", ..." if len(listed) > 4 else "")
