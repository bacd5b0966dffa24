"""Fingerprint of an experiment: title, records and a digest, to match answers and records."""

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

    The packing of a file does not change it; another unit, sign or column does.
    """
    whole = hashlib.sha256()
    for r in experiment.records:
        cuts = [(s.start, s.stop) for s in r.segments]
        whole.update(repr((r.file, r.use, sorted(r.offset_names), r.sample_time, cuts)).encode())
        for name in sorted(r.signals):
            whole.update(f"{name} {len(r.signals[name])} ".encode())
            whole.update(np.ascontiguousarray(r.signals[name], dtype="<f8").tobytes())
    return whole.hexdigest()


def difference(expected: Mapping[str, Any], experiment: Experiment) -> str | None:
    """How the expected experiment differs from this one, in words; None: they are equal."""
    present = experiment_data(experiment)
    for key, words in (("title", "title"), ("axes", "bodies"), ("records", "records")):
        if expected[key] != present[key]:
            return f"{words} {_shorten(expected[key])}, found {_shorten(present[key])}"
    if expected["digest"] != present["digest"]:
        return "records of the same names, but they read differently now"
    return None


def bodies_text(axes: Mapping[str, str]) -> str:
    """Names of bodies with their axes, as text: "device (prismatic)"."""
    return ", ".join(f"{place} ({axis})" for place, axis in axes.items())


def _shorten(entry: Any) -> str:
    if isinstance(entry, str):
        return f'"{entry}"' if len(entry) <= 60 else f'"{entry[:57]}..."'
    if isinstance(entry, Mapping):
        return bodies_text(entry)
    listed = [f"{r['file']} ({r['use']}, {r['samples']} samples)" for r in entry]
    return ", ".join(listed[:4]) + (", ..." if len(listed) > 4 else "")
