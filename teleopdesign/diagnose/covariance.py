"""Covariance of the estimates of a fit: of its parameters, and as those of a diagram's blocks.

And correlations of what it leaves: a right model leaves a residual that depends neither on its own
past nor on the command. The residual is low-passed: below its bandwidth B only samples 1/(2 B)
apart are new, and only these count.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri

from ..base.errors import ModelError, unknown
from ..frequency.confidence import ParameterCovariance
from ..measurement.filtering import Array
from ..measurement.friction_curve import points_as_motion
from ..measurement.prepare import Prepared
from ..model import Model
from ..realise.along_motion import residual_along
from .fit import Fit, estimate, sandwich
from .record_offsets import as_logged
from .search_plan import EFFORTS


def covariance_of(fit: Fit) -> Array:
    """Covariance (p, p) of the estimates of a fit, with the standard errors that its model states.

    Correlations are those of the sandwich estimate. The standard errors also contain errors of the
    readings and shifts of the records. A parameter without a finite one counts as known.
    """
    scaled, _, sensitive = sandwich(fit.jacobian, fit.fit_residual, fit.fit_blocks)
    stated = np.array([fit.model.parameters[n].stderr for n in fit.free])[sensitive]
    unit = np.where(np.isfinite(stated), stated, 0.0)
    unit = unit / np.sqrt(np.maximum(np.diag(scaled), 1e-300))
    covariance = np.zeros((len(fit.free), len(fit.free)))
    covariance[np.ix_(sensitive, sensitive)] = scaled * np.outer(unit, unit)
    return covariance


def covariance_in_blocks(
    model: Model, prepared: Prepared, blocks: Mapping[str, str] | None = None
) -> ParameterCovariance:
    """The covariance of a model's estimates on the fit records, by the parameters of a diagram.

    blocks: block of the diagram -> body of the model that it is; None: "Z_M" is the only body
    raises ModelError: no such body, or several bodies and no mapping
    """
    places = model.bodies
    if blocks is None:
        if len(places) > 1:
            raise ModelError(
                f"covariance: found {len(places)} bodies, expected blocks, such as "
                f'{{"Z_M": "{next(iter(places))}"}}'
            )
        blocks = {"Z_M": next(iter(places))}
    for place in blocks.values():
        if place not in places:
            raise ModelError(f"covariance: {unknown('body', place, places)}")
    along = replace(estimate(model, prepared, effort=EFFORTS.evaluation), model=model)
    matrix = covariance_of(along)
    of_blocks = {
        f"{block}.{model.locate(name)[1]}": k
        for block, place in blocks.items()
        for k, name in enumerate(along.free)
        if model.locate(name)[0] == place
    }
    determined = {n: k for n, k in of_blocks.items() if matrix[k, k] > 0}
    kept = list(determined.values())
    undetermined = tuple(n for n in of_blocks if n not in determined)
    return ParameterCovariance(tuple(determined), matrix[np.ix_(kept, kept)], undetermined)


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


#: standard deviations of an interval of 99 %
NINETY_NINE = float(ndtri(0.995))
#: most lags that are looked at, in samples 1/(2 B) apart
LAGS = 25


@dataclass(frozen=True)
class ResidualCorrelations:
    """Correlations of the residual force of one body, dimensionless, -1 to 1.

    lag: s, (2 k + 1,);  itself: with its own past, by the lag;  command: with the command, the
        residual later by the lag
    band: 99 % of the correlations of a residual that depends on neither are smaller
    """

    lag: Array
    itself: Array
    command: Array
    band: float


def residual_correlations(model: Model, prepared: Prepared, place: str) -> ResidualCorrelations:
    """Of the longest stretch of the check records, or of the fit records if there are none.

    raises ModelError: the model has no residual along the records
    """
    stretches = [s for s in prepared.of("check") or prepared.of("fit") if s.motion.body == place]
    stretch = max(stretches, key=lambda s: s.counted_time)
    motion, body = as_logged(model, stretch.motion), model.body(place)
    every = max(round(0.5 / stretch.motion.bandwidth / motion.sample_time), 1)
    at = stretch.keep[::every]
    left = motion.lowpassed(residual_along(body, motion).residual.value)[at]
    command = motion.lowpassed(motion.at_rows(motion.command))[at]
    count = min(LAGS, len(at) // 4)
    return ResidualCorrelations(
        np.arange(-float(count), count + 1) * (every * motion.sample_time),
        _correlation(left, left, count),
        _correlation(command, left, count),
        NINETY_NINE / float(np.sqrt(len(at))),
    )


def _correlation(cause: Array, effect: Array, count: int) -> Array:
    """Correlation of two signals, the second later by -count to count samples."""
    a, b = cause - np.mean(cause), effect - np.mean(effect)
    whole = np.correlate(b, a, "full") / max(float(np.linalg.norm(a) * np.linalg.norm(b)), 1e-300)
    middle = len(a) - 1
    return np.asarray(whole[middle - count : middle + count + 1])
