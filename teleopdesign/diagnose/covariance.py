"""Covariance of the estimates of a fit: of its parameters, and as those of a diagram's blocks."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..base.errors import ModelError, unknown
from ..frequency.confidence import ParameterCovariance
from ..measurement.filtering import Array
from .fit import Fit, sandwich


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


def covariance_in_blocks(fit: Fit, blocks: Mapping[str, str] | None) -> ParameterCovariance:
    """The covariance by the parameters of a diagram.

    blocks: block of the diagram -> body of the model that it is; None: "Z_M" is the only body
    raises ModelError: no such body, or several bodies and no mapping
    """
    places = fit.model.bodies
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
    located = [fit.model.locate(name) for name in fit.free]
    matrix, kept, names, undetermined = covariance_of(fit), [], [], []
    for block, place in blocks.items():
        for k, (at, local) in enumerate(located):
            if at != place:
                continue
            if not np.isfinite(fit.model.parameters[fit.free[k]].stderr):
                undetermined.append(f"{block}.{local}")
                continue
            kept.append(k)
            names.append(f"{block}.{local}")
    return ParameterCovariance(tuple(names), matrix[np.ix_(kept, kept)], tuple(undetermined))
