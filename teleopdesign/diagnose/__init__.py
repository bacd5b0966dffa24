"""Compare a model with an experiment, see where it fails, and find the effect that is missing."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .answer import load_answer as load_answer
    from .answer import write_answer as write_answer
    from .by_simulation import HorizonError as HorizonError
    from .by_simulation import SimulationComparison as SimulationComparison
    from .comparison import Comparison as Comparison
    from .comparison import compare as compare
    from .diagnosis import Diagnosis as Diagnosis
    from .driven import RecordedLoop as RecordedLoop
    from .estimates import fit as fit
    from .estimates import rank as rank
    from .fit import Fit as Fit
    from .ladder import find_missing as find_missing
    from .ranking import Ranked as Ranked
    from .ranking import Ranking as Ranking
    from .statements import LadderRow as LadderRow

__getattr__, __dir__, __all__ = lazy_face(__name__)
