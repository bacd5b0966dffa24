"""Which parameter a measure depends on most: Sobol indices, estimated by SALib.

The first index is the share of the measure's variance that a parameter causes alone. The total
index adds the variance that the parameter causes together with other parameters. The sum of the
first indices is 1 if the parameters act independently of each other.
"""

from __future__ import annotations

import json
import warnings
from typing import TYPE_CHECKING

import numpy as np

from ..base.errors import ExperimentError, ModelError
from .points import SAMPLE

if TYPE_CHECKING:
    import xarray

    from .result import Study

#: resamplings of the estimate's interval, as SALib takes by default
_RESAMPLED = 100


def sensitivity(study: Study, measure: str = "") -> xarray.Dataset:
    """`first` and `total` Sobol indices over `parameter`, with half their 95 % intervals.

    measure: name; may be omitted if there is only one
    raises ModelError: the points are not from `sensitivity_samples`, some failed, or the measure
        never varies
    raises ExperimentError: SALib is not installed
    """
    import xarray

    try:
        from SALib.analyze import sobol
    except ImportError:
        raise ExperimentError(
            "sensitivity: Sobol indices need SALib: pip install 'teleopdesign[studies]'"
        ) from None
    name = measure or _require_one(study)
    values, attrs = study[name], study.data.attrs
    if attrs.get("sampling") != "sensitivity" or values.dims != (SAMPLE,):
        raise ModelError(
            "sensitivity: Sobol indices need points of sensitivity_samples alone, and a number at "
            f"each; found {attrs.get('sampling') or 'a grid'} over "
            f"{', '.join(map(str, values.dims))}"
        )
    numbers = values.values.astype(float)
    if bad := int((~np.isfinite(numbers)).sum()):
        raise ModelError(
            f"sensitivity: {name}: {bad} of {len(numbers)} points are no numbers; Sobol "
            "indices need all"
        )
    if np.ptp(numbers) == 0:
        raise ModelError(f"sensitivity: {name}: is {numbers[0]:g} at every point: nothing depends")
    names = json.loads(attrs["axes"])
    problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", FutureWarning)  # of pandas, inside SALib
        indices = sobol.analyze(
            problem,
            numbers,
            calc_second_order=False,
            num_resamples=_RESAMPLED,
            seed=int(attrs["sampling_seed"]),
        )
    text = {"units": "1"}
    return xarray.Dataset(
        {
            "first": ("parameter", np.asarray(indices["S1"]), text),
            "first_interval": ("parameter", np.asarray(indices["S1_conf"]), text),
            "total": ("parameter", np.asarray(indices["ST"]), text),
            "total_interval": ("parameter", np.asarray(indices["ST_conf"]), text),
        },
        {"parameter": names},
        {"measure": name, "method": "Saltelli et al. (2010), by SALib"},
    )


def _require_one(study: Study) -> str:
    if len(study.measures) != 1:
        raise ModelError(f"sensitivity: which measure? It has {', '.join(study.measures)}")
    return study.measures[0]
