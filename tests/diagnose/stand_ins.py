"""Fits, candidates and floors that hold the numbers which a decision reads: no record is fitted."""

from types import SimpleNamespace

import numpy as np

from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.noise_floor import NoiseFloor
from teleopdesign.diagnose.ranking import Ranked
from teleopdesign.effects import EFFECTS

BLOCKS = np.repeat(np.arange(40), 10)
#: of 400 rows; without noise each difference counts
SHAPE = np.sin(np.arange(400.0))
SHAPE /= np.linalg.norm(SHAPE)


def floor(value=0.1, **more):
    return NoiseFloor(value, "made", value, **more)


class Leaves(SimpleNamespace):
    """What a fit leaves, as stated."""

    @property
    def check_error_at_command(self):
        return self.at_command.error

    @property
    def blind(self):
        return self.at_command.blind


def fit(error, *, blind=0.0, at_command=None, residual=None, known=("device",)):
    """A fit that leaves this error, of the force and at the command."""
    left = error * SHAPE if residual is None else residual
    error_there = error if at_command is None else at_command
    command = SimpleNamespace(
        error=error_there,
        blind=blind,
        residual=error_there * SHAPE if residual is None else residual,
        sighted=np.ones(400, dtype=bool),
    )
    return Leaves(
        fit_error=error,
        check_error=error,
        check_residual=left,
        check_blocks=BLOCKS,
        fit_residual=left,
        fit_blocks=BLOCKS,
        at_command=command,
        at_bound=(),
        model=SimpleNamespace(known=dict.fromkeys(known), parameters={}),
    )


def ranked(error, effect="stribeck", **more):
    """A candidate whose fit leaves this error."""
    identifiable = more.pop("is_identifiable", True)
    instead = more.pop("instead_of", None)
    reasons = {k: more.pop(k) for k in ("refused", "implausible") if k in more}
    candidate = Candidate(EFFECTS[effect], "device")
    return Ranked(
        candidate, fit(error, **more), 9.0, 0.0, identifiable, instead_of=instead, **reasons
    )


def rung(error, added=None, alternatives=()):
    left = fit(error)
    return SimpleNamespace(added=added, fit=left, alternatives=alternatives)
