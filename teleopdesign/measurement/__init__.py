"""Measurements: read an experiment's folder, with signals in SI units on a uniform time.

    from teleopdesign.measurement import load_experiment
    experiment = load_experiment("rod")
    experiment.fit_records[0].signals["device.position"]    # m, shape (n,)

`fetch` (in `recordings`) obtains public recordings of real devices in the same form.
"""

from ..arguments import check_arguments
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
