"""A measured force that hardly varies: any motion under it is explained by a constant friction.

The force fixes the scale of all others. Where it is the same at all times, inertia, damping and
every effect may be zero beside a friction (of a motion in one direction, a constant force) of that
size, so that nothing can be told of them, whatever the motion is. Known inertias fix the scale too.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..measurement.first_guess import VARIES, hardly_varies
from ..measurement.prepare import Stretch, measured_force
from ..model import Model


def is_constant(stretches: Sequence[Stretch]) -> bool:
    """Whether the measured force hardly varies in any stretch, and has one size in all of them."""
    forces = [measured_force(s) for s in stretches]
    sizes = np.concatenate([np.abs(f) for f in forces])
    return all(map(hardly_varies, (*forces, sizes)))


def lacks_scale(stretches: Sequence[Stretch], model: Model) -> bool:
    """Whether a constant force is all that is known: then no effect can be told from friction."""
    inertias = [v for name, v in model.parameters.items() if name.endswith(".inertia")]
    return not any(v.fixed and v.value > 0.0 for v in inertias) and is_constant(stretches)


def constant_force_line(stretches: Sequence[Stretch]) -> str | None:
    """A sentence where the measured force hardly varies; else None."""
    if not is_constant(stretches):
        return None
    return (
        f"records: the measured force varies by less than {100 * VARIES:g} %: a constant "
        "friction explains it along any motion, and its error says nothing of the inertia or of "
        "friction that varies. Record a motion under a force that varies, or one that also coasts"
    )


def describe_constant_force() -> str:
    """The end of a verdict where nothing can be told."""
    return "The force is constant, so that these records tell no effect and no inertia."
