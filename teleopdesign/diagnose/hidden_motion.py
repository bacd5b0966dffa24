"""Records with too few rows in motion: where friction holds the body, no model is tested."""

from __future__ import annotations

import numpy as np

from ..measurement.hidden_motion import find_hidden_motion
from ..measurement.prepare import Prepared, Stretch
from ..model import Model
from .criteria import CRITERIA


def describe_hidden_motion(prepared: Prepared, model: Model) -> str:
    """Why too few rows of the fit or check records test a model, as sentences; "": enough do.

    Rows of a fit hold at least as many independent values (`few_values`) as parameters are
    estimated from them, and those of a check `Criteria.for_each`.
    """
    estimated = float(sum(not v.fixed for v in model.parameters.values()))
    for use, least in (("fit", estimated), ("check", CRITERIA.for_each)):
        stretches = prepared.of(use)
        seconds = sum(_tested_time(s, model) for s in stretches)
        if not stretches or 2.0 * prepared.bandwidth * seconds >= least:
            continue
        whole = sum(s.counted_time for s in stretches)
        for body in {s.motion.body: None for s in stretches}:
            hidden = find_hidden_motion(prepared.experiment, body, prepared.bandwidth)
            if hidden is not None and 2.0 * hidden.proposed * hidden.shown * whole >= least:
                return f"B{str(hidden)[1:]}"
        return (
            f"The position tells a motion for only {seconds:.2g} s of the {use} records. At other "
            "times static friction balances any force, and no model is tested: record more motion."
        )
    return ""


def _tested_time(stretch: Stretch, model: Model) -> float:
    """Time (s) for which a stretch tests the model of its body."""
    motion = stretch.motion
    if model.body(motion.body).level() == 0:
        return stretch.counted_time
    moving = np.count_nonzero(motion.direction[stretch.keep])
    return moving * stretch.weight * motion.sample_time
