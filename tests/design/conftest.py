import pytest
from design.devices import CANCELLATION, FEEDBACK, LOOP, LUGRE, body

from teleopdesign.diagrams import haptic_interface


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
