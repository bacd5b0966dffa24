"""Measurements: read an experiment's folder into signals in SI units on a uniform time grid.

    from teleopdesign.measurement import load_experiment

    experiment = load_experiment("rod")
    experiment.fit_records[0].signals["device.position"]  # m, shape (n,)

`fetch` (in `recordings`) downloads public recordings of real devices and converts them to the same
form.
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .channel import Channel as Channel
    from .description import BodyDescription as BodyDescription
    from .description import EnvironmentDescription as EnvironmentDescription
    from .description import ModelValue as ModelValue
    from .experiment import Experiment as Experiment
    from .experiment import load_experiment as load_experiment
    from .record import Record as Record

__getattr__, __dir__, __all__ = lazy_face(__name__)
