"""The next experiment: the motion that best distinguishes effects that a diagnosis leaves open.

proposal = propose(find_missing(experiment))
proposal                                    # what to run, and what it will show
write_reference(proposal.reference, experiment, "next.csv")
show_in_simulation(proposal)                # each rival is made the truth, and diagnosed
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .arm_paths import ArmPaths as ArmPaths
    from .arm_paths import propose_paths as propose_paths
    from .limits import Limits as Limits
    from .limits import shown_limits as shown_limits
    from .prediction import DeterminedParameter as DeterminedParameter
    from .prediction import Separation as Separation
    from .proposal import Proposal as Proposal
    from .proposal import Reference as Reference
    from .proposal import proposal_data as proposal_data
    from .proposal import write_reference as write_reference
    from .propose import SimulatedDiagnosis as SimulatedDiagnosis
    from .propose import propose as propose
    from .propose import show_in_simulation as show_in_simulation
    from .remedies import Remedy as Remedy
    from .rivals import Rival as Rival

__getattr__, __dir__, __all__ = lazy_face(__name__)
