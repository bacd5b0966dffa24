"""What single checks that need a fit say."""

from teleopdesign.check import CheckedRecording
from teleopdesign.fitted_checks._list import FITTED_CHECKS


def disagreements(model, prepared):
    """Findings on signs, units and timing of forces, motion and model."""
    return ask_fitted("agreement", model, prepared)


def ask_fitted(check, model, prepared):
    """What one check says of prepared records with a model."""
    recording = CheckedRecording(prepared.experiment, model, prepared)
    return list(FITTED_CHECKS[check].find(recording))
