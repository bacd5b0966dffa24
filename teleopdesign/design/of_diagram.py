"""The device of a whole diagram, with what its diagnosis says of computer and hand."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from ..base.errors import ModelError, unknown
from ..block_cuts import BlockDiagnosis
from ..diagnose import Diagnosis
from ..diagrams import Attached, Moving
from .assumptions import Assumptions


def device_of_diagram(
    diagnosis: BlockDiagnosis, place: str | None, assumptions: Assumptions | None
) -> tuple[Diagnosis, str, Assumptions]:
    """The diagnosis of a device, its place, and the assumptions that the diagram completes.

    The load is the identified inertia of the hand, the delay that of the computer: as stated, and
    as identified beyond. What the caller assumes stands.
    raises ModelError: no such device, or the records do not test it
    """
    experiment, diagram = diagnosis.experiment, diagnosis.experiment.diagram
    devices = [b for b in diagram.blocks if isinstance(b, Moving) and b.name in diagnosis.bodies]
    names = [b.name for b in devices]
    if place is None and len(devices) != 1:
        raise ModelError(f"design: place: expected one of {', '.join(names) or 'none'}")
    if place is not None and place not in names:
        raise ModelError(f"design: {unknown('place', place, names)}")
    device = next(b for b in devices if place in (None, b.name))
    computer, settings = experiment.computer, assumptions or Assumptions()
    late = computer.delay + sum(
        p.value
        for p, _ in diagnosis.placed
        if p.key in diagnosis.missing and p.effect.name == "delay" and p.at == "computer"
    )
    held = [b for b in diagram.blocks if isinstance(b, Attached) and b.motion == device.motion]
    tested = [b.name for b in held if b.name in diagnosis.bodies]
    loads = [diagnosis.bodies[n].model.parameters[f"{n}.inertia"].value for n in tested]
    known = {
        "sample_period": computer.sample_period,
        "delay": late or None,
        "load": sum(loads) or None,
    }
    if np.isfinite(computer.velocity_bandwidth):
        known["velocity_bandwidth"] = computer.velocity_bandwidth
    missing: dict[str, Any] = {n: v for n, v in known.items() if getattr(settings, n) is None}
    return diagnosis.bodies[device.name], device.name, replace(settings, **missing)
