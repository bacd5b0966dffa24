"""Under CI the property-based tests draw the same examples each time; elsewhere new ones.

None has a time limit: machines are loaded.

The truth simulator of tests/hidden can be imported everywhere.
"""

import os
import sys
from pathlib import Path

import pytest
from devices import CANCELLATION, FEEDBACK, LOOP, LUGRE, body
from hypothesis import settings

from teleopdesign.diagrams import haptic_interface

sys.path.insert(0, str(Path(__file__).parent / "hidden"))

settings.register_profile("untimed", deadline=None)
settings.register_profile("ci", settings.get_profile("untimed"), derandomize=True)
settings.load_profile("ci" if os.environ.get("CI") else "untimed")


@pytest.fixture
def hybrid():
    """LuGre device, 0.5 kg in place of the hand, hybrid compensation, position loop."""
    return haptic_interface(
        body(**LUGRE),
        hand=body(0.5),
        cancellation=CANCELLATION,
        force_feedback=FEEDBACK,
        position_loop=LOOP,
    )
