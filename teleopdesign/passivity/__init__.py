"""Passivity: claims about a port, each proved, refuted, supported by numbers, or unknown.

    from teleopdesign.passivity import dahl_compensation, positive_real

    claim = positive_real(0.15 * s + 4)      # force over velocity, N s/m
    claim.status, claim.verdict              # "proved", by what, with which margin
    claim.certificates[0].write("c.json")    # python -m teleopdesign.passivity.checker c.json

A refuted claim contains a motion that releases energy: `claim.record.replay()`.
"""

from ..base.arguments import check_arguments
from .available_storage import AvailableStorage, available_storage
from .claims.certificate import Certificate, read_certificate
from .claims.claim import Claim, Evidence, Proof, Refutation, Unknown
from .claims.counterexample_files import read_record, write_record
from .claims.second_opinion import SecondOpinion, second_opinion
from .diagram_claims import DiagramClaims, Search, diagram_claims
from .intervals.interval_claim import IntervalClaim
from .intervals.over_box import claim_over_intervals
from .linear.hand_port import hand_port
from .linear.impedance import Impedance, impedance
from .linear.kyp import Kyp, kyp, storage_function
from .linear.positive_real import Excess, damping_excess, mobility_excess, positive_real
from .margin_map import MarginMap, margin_map
from .observer import (
    PassivityControlled,
    PortEnergy,
    observe,
    observe_record,
    observe_simulation,
    passivity_controlled,
)
from .ports import Port, ports
from .rate_independent import (
    Coulomb,
    Cycle,
    Dahl,
    DahlBehindSpring,
    Spring,
    symmetric_cycle,
)
from .regions import Region, region
from .search.by_simulation import (
    Given,
    SimulatedMotion,
    confirmed_motion,
    released_energy,
    search_counterexample,
)
from .search.stroke_motion import Strokes
from .theorems.bounded_compensation import bounded_compensation
from .theorems.compliant_transmission import any_environment, free_motion, free_motion_margin
from .theorems.dahl_compensation import (
    dahl_compensation,
    largest_one_off_energy,
    largest_passive_level,
    largest_ratio,
    onset_amplitude,
    self_motion_speed,
)
from .theorems.delayed_compensation import (
    delayed_small_motion,
    inertia_given_out,
    released_by_delay,
)
from .theorems.delayed_coupling import delayed_spring
from .theorems.delayed_inertia import cancelled_inertia, damping_given_out, largest_passive_inertia
from .theorems.energy_tank import energy_tank
from .theorems.lugre import lugre_passivity
from .theorems.quantised_spring import quantised_spring, stiffest_spring
from .theorems.sampled_compensation import Trembling, sampled_compensation
from .theorems.sampled_data import required_damping, sampled_coupling, sampled_passivity
from .theorems.velocity_compensation import SteadyStrokes, velocity_compensation
from .theorems.wave_channel import wave_channel, wave_claim, wave_teleoperator
from .two_port.claims import absolutely_stable, passive
from .two_port.two_port import (
    FrequencyMargins,
    TwoPort,
    sweep_margins,
    teleoperator_two_port,
    two_port,
)
from .z_width import WALL_DAMPING, WALL_STIFFNESS, ZWidth, z_width

__all__ = [
    "WALL_DAMPING",
    "WALL_STIFFNESS",
    "AvailableStorage",
    "Certificate",
    "Claim",
    "Coulomb",
    "Cycle",
    "Dahl",
    "DahlBehindSpring",
    "DiagramClaims",
    "Evidence",
    "Excess",
    "FrequencyMargins",
    "Given",
    "Impedance",
    "IntervalClaim",
    "Kyp",
    "MarginMap",
    "PassivityControlled",
    "Port",
    "PortEnergy",
    "Proof",
    "Refutation",
    "Region",
    "Search",
    "SecondOpinion",
    "SimulatedMotion",
    "Spring",
    "SteadyStrokes",
    "Strokes",
    "Trembling",
    "TwoPort",
    "Unknown",
    "ZWidth",
    "absolutely_stable",
    "any_environment",
    "available_storage",
    "bounded_compensation",
    "cancelled_inertia",
    "claim_over_intervals",
    "confirmed_motion",
    "dahl_compensation",
    "damping_excess",
    "damping_given_out",
    "delayed_small_motion",
    "delayed_spring",
    "diagram_claims",
    "energy_tank",
    "free_motion",
    "free_motion_margin",
    "released_energy",
    "released_by_delay",
    "hand_port",
    "impedance",
    "inertia_given_out",
    "kyp",
    "largest_one_off_energy",
    "largest_passive_inertia",
    "largest_passive_level",
    "largest_ratio",
    "lugre_passivity",
    "margin_map",
    "mobility_excess",
    "observe",
    "observe_record",
    "observe_simulation",
    "onset_amplitude",
    "sweep_margins",
    "passive",
    "passivity_controlled",
    "ports",
    "positive_real",
    "quantised_spring",
    "read_certificate",
    "read_record",
    "region",
    "required_damping",
    "sampled_compensation",
    "sampled_coupling",
    "sampled_passivity",
    "search_counterexample",
    "second_opinion",
    "self_motion_speed",
    "stiffest_spring",
    "storage_function",
    "symmetric_cycle",
    "teleoperator_two_port",
    "two_port",
    "velocity_compensation",
    "wave_channel",
    "wave_claim",
    "wave_teleoperator",
    "write_record",
    "z_width",
]

check_arguments(globals(), __all__)
