"""Findings about a recording that need no fit: one list for `new`, `check`, `diagnose` and the app.

Is the recording sound, do its columns say what their labels say, may it tell an effect at all? A
check is one file of this folder, and is in the list by being there:

    CHECK = RecordingCheck(order=35, find=find_jumps)

    def find_jumps(recording: CheckedRecording) -> Iterator[Finding]: ...

A `Finding` has topic, concern, sentence, numbers, place and graph. One that `stops` ends a
diagnosis: these records tell no effect, and its sentence says what mends that. Nothing else judges
a recording without a fit. `fitted_checks` holds checks of the same kind that fit a model.
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from ._recording import CHECKS as CHECKS
    from ._recording import CheckedRecording as CheckedRecording
    from ._recording import RecordingCheck as RecordingCheck
    from ._recording import findings_of as findings_of
    from ._recording import in_turn as in_turn
    from ._recording import look_at as look_at
    from ._recording import not_checked as not_checked
    from ._recording import stopping_findings as stopping_findings
    from ._recording import why_silent as why_silent

__getattr__, __dir__, __all__ = lazy_face(__name__)
