"""Measurements: read an experiment's folder into signals in SI units on a uniform time grid.

    from teleopdesign.measurement import load_experiment

    experiment = load_experiment("rod")
    experiment.fit_records[0].signals["device.position"]  # m, shape (n,)

`fetch` (in `recordings`) downloads public recordings of real devices and converts them to the same
form.
"""

from ..base.arguments import check_arguments
from .channel import Channel
from .description import BodyDescription, EnvironmentDescription, ModelValue
from .experiment import Experiment, load_experiment
from .record import Record

__all__ = [
    "BodyDescription",
    "Channel",
    "EnvironmentDescription",
    "Experiment",
    "ModelValue",
    "Record",
    "load_experiment",
]

check_arguments(globals(), __all__)
