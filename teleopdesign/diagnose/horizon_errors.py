"""How far a simulated motion is from the measured one, and the controller that held both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError


@check_types
@dataclass(frozen=True)
class RecordedLoop:
    """The controller of the device during the recording, as a spring and a damper.

    stiffness: N/m or N m/rad;  damping: N s/m or N m s/rad;  both finite and not negative
    """

    stiffness: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not (0.0 <= self.stiffness < np.inf and 0.0 <= self.damping < np.inf):
            raise ModelError(
                "RecordedLoop: expected stiffness and damping of zero or more, found "
                f"{self.stiffness:g}, {self.damping:g}"
            )


@dataclass(frozen=True)
class HorizonError:
    """Errors of one body that restarts on the measured motion after each horizon.

    horizon: s; inf: each whole stretch of a record
    position, velocity: rms difference from the measured motion (SI); inf: the motion is not finite
    of_travel, of_speed: the same over the standard deviation of the position, the rms velocity
    """

    use: str
    at: str
    horizon: float
    position: float
    velocity: float
    of_travel: float
    of_speed: float

    @property
    def fit(self) -> float:
        """Fit of the position in %: 100 for the measured motion, 0 for its mean (NRMSE)."""
        return 100.0 * (1.0 - self.of_travel)
