"""A measured force that hardly varies: any motion under it is explained by a constant friction.

The force fixes the scale of all others. Where it is the same at all times, inertia, damping and
every effect may be zero beside a friction (of a motion in one direction, a constant force) of that
size, so that nothing can be told of them, whatever the motion is. Known inertias fix the scale too.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..base.finding import Finding
from ..measurement.first_guess import VARIES, hardly_varies
from ..measurement.prepare import measured_force
from ._recording import CheckedRecording, RecordingCheck


def find_constant_force(recording: CheckedRecording) -> Iterator[Finding]:
    """Whether the force has one size in all stretches, where no inertia is known."""
    if recording.model is None or recording.prepared is None:
        return
    inertias = [v for n, v in recording.model.parameters.items() if n.endswith(".inertia")]
    if any(v.fixed and v.value > 0.0 for v in inertias):
        return
    forces = [measured_force(s) for s in recording.prepared.stretches]
    sizes = np.concatenate([np.abs(f) for f in forces])
    if all(map(hardly_varies, (*forces, sizes))):
        sentence = (
            f"The force is constant, within {100 * VARIES:g} %: a constant friction explains it "
            "along any motion, so that these records tell no inertia, no damping and no effect. "
            "Record a motion under a force that varies, or one that also coasts; or state the "
            "inertia, with fixed = true."
        )
        yield Finding("constant force", "warning", sentence, stops=True)


CHECK = RecordingCheck(order=200, find=find_constant_force, may_stop=True)
