"""The next experiment: the motion that best distinguishes effects that a diagnosis leaves open.

proposal = propose(find_missing(experiment))
proposal                                    # what to run, and what it will show
write_reference(proposal.reference, experiment, "next.csv")
show_in_simulation(proposal)                # each rival is made the truth, and diagnosed
"""

from ..base.arguments import check_arguments
from .arm_paths import ArmPaths, propose_paths
from .in_simulation import SimulatedDiagnosis, show_in_simulation
from .limits import Limits, shown_limits
from .prediction import DeterminedParameter, Separation
from .proposal import Proposal, Reference
from .propose import propose
from .reference_csv import write_reference
from .remedies import Remedy
from .rivals import Rival
from .words import proposal_data

__all__ = [
    "ArmPaths",
    "DeterminedParameter",
    "Limits",
    "Proposal",
    "Reference",
    "Remedy",
    "Rival",
    "Separation",
    "SimulatedDiagnosis",
    "proposal_data",
    "propose",
    "propose_paths",
    "show_in_simulation",
    "shown_limits",
    "write_reference",
]

check_arguments(globals(), __all__)
