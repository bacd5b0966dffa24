"""The friction that a model has at given speeds, with the standard error of the curve."""

from __future__ import annotations

import numpy as np

from ..measurement.filtering import Array
from ..measurement.friction_curve import points_as_motion
from ..realise.along_motion import residual_along
from .covariance import covariance_of
from .fit import Fit


def friction_at(fit: Fit, velocity: Array) -> tuple[Array, Array]:
    """Force (n,) that holds a body at these speeds (n,), and its standard error.

    fit: of a friction curve
    """
    (place,) = fit.model.bodies
    names = [fit.model.locate(name)[1] for name in fit.free]
    motion = points_as_motion(place, "", velocity, np.zeros(len(velocity)))
    left = residual_along(fit.model.bodies[place], motion, names).residual
    variance = np.einsum("pn,pq,qn->n", left.tangent, covariance_of(fit), left.tangent)
    return -left.value, np.sqrt(np.maximum(variance, 0.0))
