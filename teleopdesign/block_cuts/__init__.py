"""A whole diagram against its recording: cuts at recorded signals, and the block that is wrong."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .channel_proposal import ChannelProposal as ChannelProposal
    from .channel_proposal import propose_channels as propose_channels
    from .cuts import Cut as Cut
    from .cuts import Cuts as Cuts
    from .cuts import cuts_of as cuts_of
    from .diagnosis import BlockDiagnosis as BlockDiagnosis
    from .diagram_experiment import DiagramExperiment as DiagramExperiment
    from .reading import diagram_experiment as diagram_experiment
    from .reading import load_experiment as load_experiment
    from .saved import load_answer as load_answer
    from .saved import write_answer as write_answer
    from .search import compare as compare
    from .search import describe as describe
    from .search import find_missing as find_missing
    from .search import rank as rank
    from .what_to_log import LoggingPlan as LoggingPlan
    from .what_to_log import what_to_log as what_to_log

__getattr__, __dir__, __all__ = lazy_face(__name__)
