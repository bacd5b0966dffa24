"""Passivity: claims about a port, each proved, refuted, supported by numbers, or unknown.

    from teleopdesign.passivity import dahl_compensation, positive_real

    claim = positive_real(0.15 * s + 4)      # force over velocity, N s/m
    claim.status, claim.verdict              # "proved", by what, with which margin
    claim.certificates[0].write("c.json")    # python -m teleopdesign.passivity.checker c.json

A refuted claim contains a motion that releases energy: `claim.record.replay()`.
"""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .available_storage import AvailableStorage as AvailableStorage
    from .available_storage import available_storage as available_storage
    from .claims.certificate import Certificate as Certificate
    from .claims.certificate import read_certificate as read_certificate
    from .claims.claim import Claim as Claim
    from .claims.claim import Evidence as Evidence
    from .claims.claim import Proof as Proof
    from .claims.claim import Refutation as Refutation
    from .claims.claim import Region as Region
    from .claims.claim import Unknown as Unknown
    from .claims.claim import region as region
    from .claims.counterexample_files import read_record as read_record
    from .claims.counterexample_files import write_record as write_record
    from .diagram_claims import DiagramClaims as DiagramClaims
    from .diagram_claims import Search as Search
    from .diagram_claims import diagram_claims as diagram_claims
    from .intervals.box import IntervalClaim as IntervalClaim
    from .intervals.over_box import claim_over_intervals as claim_over_intervals
    from .linear.excess import Excess as Excess
    from .linear.excess import damping_excess as damping_excess
    from .linear.impedance import Impedance as Impedance
    from .linear.impedance import impedance as impedance
    from .linear.judge import positive_real as positive_real
    from .linear_diagrams import hand_port as hand_port
    from .margin_map import MarginMap as MarginMap
    from .margin_map import margin_map as margin_map
    from .observer import PassivityControlled as PassivityControlled
    from .observer import PortEnergy as PortEnergy
    from .observer import observe as observe
    from .observer import observe_record as observe_record
    from .observer import observe_simulation as observe_simulation
    from .observer import passivity_controlled as passivity_controlled
    from .ports import Port as Port
    from .ports import ports as ports
    from .rate_independent import Coulomb as Coulomb
    from .rate_independent import Cycle as Cycle
    from .rate_independent import Dahl as Dahl
    from .rate_independent import DahlBehindSpring as DahlBehindSpring
    from .rate_independent import Spring as Spring
    from .rate_independent import symmetric_cycle as symmetric_cycle
    from .search.by_simulation import Given as Given
    from .search.by_simulation import SimulatedMotion as SimulatedMotion
    from .search.by_simulation import confirmed_motion as confirmed_motion
    from .search.by_simulation import released_energy as released_energy
    from .search.by_simulation import search_counterexample as search_counterexample
    from .search.stroke_motion import Strokes as Strokes
    from .theorems.bounded_compensation import bounded_compensation as bounded_compensation
    from .theorems.channels import energy_tank as energy_tank
    from .theorems.channels import wave_channel as wave_channel
    from .theorems.channels import wave_claim as wave_claim
    from .theorems.channels import wave_teleoperator as wave_teleoperator
    from .theorems.compliant_transmission import any_environment as any_environment
    from .theorems.compliant_transmission import free_motion as free_motion
    from .theorems.compliant_transmission import free_motion_margin as free_motion_margin
    from .theorems.dahl_compensation import dahl_compensation as dahl_compensation
    from .theorems.dahl_compensation import largest_one_off_energy as largest_one_off_energy
    from .theorems.dahl_compensation import largest_passive_level as largest_passive_level
    from .theorems.dahl_compensation import largest_ratio as largest_ratio
    from .theorems.dahl_compensation import onset_amplitude as onset_amplitude
    from .theorems.delays import cancelled_inertia as cancelled_inertia
    from .theorems.delays import damping_given_out as damping_given_out
    from .theorems.delays import delayed_small_motion as delayed_small_motion
    from .theorems.delays import delayed_spring as delayed_spring
    from .theorems.delays import largest_passive_inertia as largest_passive_inertia
    from .theorems.lugre import lugre_passivity as lugre_passivity
    from .theorems.quantised_spring import quantised_spring as quantised_spring
    from .theorems.quantised_spring import stiffest_spring as stiffest_spring
    from .theorems.sampled_compensation import Trembling as Trembling
    from .theorems.sampled_compensation import sampled_compensation as sampled_compensation
    from .theorems.sampled_data import required_damping as required_damping
    from .theorems.sampled_data import sampled_coupling as sampled_coupling
    from .theorems.sampled_data import sampled_passivity as sampled_passivity
    from .theorems.velocity_compensation import SteadyStrokes as SteadyStrokes
    from .theorems.velocity_compensation import velocity_compensation as velocity_compensation
    from .two_port import TwoPort as TwoPort
    from .two_port import absolutely_stable as absolutely_stable
    from .two_port import passive as passive
    from .two_port import teleoperator_two_port as teleoperator_two_port
    from .two_port import two_port as two_port
    from .z_width import ZWidth as ZWidth
    from .z_width import z_width as z_width

__getattr__, __dir__, __all__ = lazy_face(__name__)
