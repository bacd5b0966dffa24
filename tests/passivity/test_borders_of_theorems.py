"""Systems that no generator draws: on a border, a hair beside it, and what hides within a system.

Each stands with what is true of it: none is proved that does not hold, none refuted that does, and
none ends in a traceback. "Unknown" is an answer, and a refusal in one line.
"""

from fractions import Fraction as F

import control as ct
import pytest
import sympy as sp

from teleopdesign.base.errors import TeleopDesignError
from teleopdesign.passivity import (
    absolutely_stable,
    any_environment,
    bounded_compensation,
    cancelled_inertia,
    dahl_compensation,
    delayed_small_motion,
    delayed_spring,
    lugre_passivity,
    passive,
    positive_real,
    quantised_spring,
    sampled_compensation,
    sampled_coupling,
    sampled_passivity,
    two_port,
    velocity_compensation,
    wave_channel,
    wave_teleoperator,
)
from teleopdesign.passivity.claims.claim import Claim, Evidence, Unknown
from teleopdesign.realise.lti import S

Z = sp.Symbol("z")
HAIR, NOTHING = F(1, 10**15), F(1, 10**30)
T = F(1, 1000)


def exact(number):
    return sp.Rational(number.numerator, number.denominator)


ONE_PORTS = [
    (sp.S(0), True),
    (-exact(NOTHING), False),
    ((S**2 + 1) ** 2 / (S * (S**2 + 4)), False),  # lossless, but a double zero on the axis
    (S * (S**2 + 2) / (S**2 + 1) ** 2, False),
    (1 / S**2, False),
    ((S**2 + S + 1) / (S**2 + S + 4), True),  # Re Z is (w^2 - 2)^2
    ((S**2 + (1 - exact(HAIR)) * S + 1) / (S**2 + S + 4), False),
    (S * 10**20 + sp.Rational(1, 10**20), True),
    ((S**2 + 1) / (S**2 - sp.Rational(1, 10**12) * S + 1), False),
    (S**3, False),
    (-S, False),
    (S - 1 / S, False),
    (S * sp.exp(-S), False),
    (ct.tf([1, 0, -1], [1, 1, -2]), False),  # (s - 1) is in both sides
    (ct.ss([[1, 0], [0, -1]], [[0], [1]], [[1, 1]], [[1]]), False),
    (ct.ss([[1, 0], [0, -1]], [[1], [1]], [[0, 1]], [[1]]), False),
    (ct.ss([[0, 1, 0], [0, 0, 0], [0, 0, -1]], [[0], [0], [1]], [[0, 0, 1]], [[1]]), False),
]
#: entries, whether it is passive, whether it is absolutely stable
TWO_PORTS = [
    ((0, 1, -1, 0), True, True),
    ((0, 1, 1, 0), False, False),
    ((1, 1, 1, 1), True, True),
    ((1, 1 + exact(HAIR), 1 + exact(HAIR), 1), False, False),
    ((1, 0, 1 / (S - 1), 1), False, False),
    ((S + 1, 0, 10**6 / (S + 1), 1), False, True),
    ((1 / S, 1 / S, 1 / S, 1 / S), True, True),
    ((1 / S, 2 / S, sp.Rational(1, 2) / S, 1 / S), False, True),  # behind a lever
    ((0, 0, 0, 0), True, True),
    ((S, 0, 0, -S * exact(NOTHING)), False, False),
    ((1, 1 / S**2, -1 / S**2, 1), False, False),
    ((1, 1 / (S**2 + 1) ** 2, -1 / (S**2 + 1) ** 2, 1), False, False),
    ((1, 1 / (S**2 + 1), -1 / (S**2 + 1), 1), False, False),
    ((1, S, -S, 1), False, False),
    ((-1, 0, 0, -1), False, False),
]
SPRING = {"master_inertia": 1, "slave_inertia": 1, "stiffness": 20, "delay": F(1, 10)}
BRISTLE = {"coulomb_level": 1, "compensator_level": F(1, 4), "presliding_stiffness": 10**4}
TWINS = {"coulomb_level": F(1, 2), "compensator_level": F(1, 2), "compensator_stiffness": 10**4,
         "presliding_stiffness": 10**4}  # fmt: skip
LUGRE = {"coulomb_level": 1, "static_level": 2, "stiffness": 10**5, "bristle_damping": 10,
         "stribeck_velocity": F(1, 100)}  # fmt: skip
EQUAL = {"coulomb_level": F(1, 2), "compensator_level": F(1, 2)}
SMOOTH = {**EQUAL, "smoothing_velocity": F(1, 100), "presliding_stiffness": 10**4}
QUARTER = {"coulomb_level": F(1, 4), "compensator_level": 1, "smoothing_velocity": 1}
LATE = {"compensator_stiffness": 1000, "delay": T}
#: minus the least sin(y)/y, fifteen digits of it, less a unit of the last and one more
SINC = F(217233628211221, 10**15)
MASS = {"inertia": 1, "damping": 10, "delay": 0, "time_constant": F(1, 10), "order": 1}
STEPS = {"damping": 1, "sample_time": T, "step": F(1, 10**5), "coulomb_level": F(1, 1000),
         "compensator_level": 0}  # fmt: skip
JOINT = {"motor_level": 1, "link_level": 0, "transmission_stiffness": 1000,
         "compensator_level": 1, "compensator_stiffness": 10**4}  # fmt: skip
SAMPLED = {"damping": 1, "sample_time": T}
HIDDEN = ct.ss([[2.0, 0], [0, 0.5]], [[0], [1]], [[1, 1]], [[0]], 1e-3)
NUMBERS = [
    (bounded_compensation, {"coulomb_level": 0.3, "bound": 0.1 + 0.2}, False),
    (bounded_compensation, {"coulomb_level": 0.1 + 0.2, "bound": 0.3}, True),
    (dahl_compensation, {**EQUAL, "compensator_stiffness": 1}, True),
    (dahl_compensation, {"coulomb_level": F(1, 2), "compensator_level": F(1, 2) + NOTHING,
                         "compensator_stiffness": 1}, False),
    (dahl_compensation, TWINS, True),
    (dahl_compensation, {**TWINS, "compensator_level": F(2, 5)}, False),
    (dahl_compensation, {**TWINS, "highest_level": 1}, False),
    (dahl_compensation, {**BRISTLE, "compensator_stiffness": 5000}, True),
    (dahl_compensation, {**BRISTLE, "compensator_stiffness": 5000 + HAIR}, False),
    (dahl_compensation, {**BRISTLE, "compensator_stiffness": 10**29}, False),
    (sampled_compensation, {**EQUAL, "compensator_stiffness": 1000, "sample_time": T}, True),
    (sampled_compensation, {"coulomb_level": F(1, 2), "compensator_level": F(1, 2) + NOTHING,
                            "compensator_stiffness": 1000, "sample_time": T}, False),
    (sampled_compensation, {**EQUAL, "compensator_stiffness": 1000, "sample_time": T,
                            "presliding_stiffness": 1000}, False),
    (lugre_passivity, {**LUGRE, "viscous_damping": 10}, True),
    (lugre_passivity, {**LUGRE, "viscous_damping": 10 - HAIR}, False),
    (lugre_passivity, {**LUGRE, "bristle_damping": 0, "viscous_damping": 0}, True),
    (velocity_compensation, EQUAL, True),
    (velocity_compensation, {**EQUAL, "presliding_stiffness": 10**4}, False),
    (velocity_compensation, {**EQUAL, "sample_time": T, "late": 9}, True),
    (velocity_compensation, {**SMOOTH, "viscous_damping": 50}, True),
    (velocity_compensation, {**SMOOTH, "viscous_damping": 50 - HAIR}, False),
    (velocity_compensation, {**QUARTER, "viscous_damping": F(1, 4)}, True),
    (velocity_compensation, {**QUARTER, "viscous_damping": F(1, 4) - HAIR}, False),
    (delayed_small_motion, {**LATE, "damping": SINC, "presliding_stiffness": 1000}, False),
    (delayed_small_motion, {**LATE, "damping": SINC + 2 * HAIR,
                            "presliding_stiffness": 1000}, True),
    (delayed_small_motion, {**LATE, "damping": 10, "presliding_stiffness": 1000 - HAIR}, False),
    (delayed_small_motion, {**LATE, "damping": 0, "delay": 0, "presliding_stiffness": 1000}, True),
    (delayed_spring, {**SPRING, "master_damping": 2, "slave_damping": 2}, True),
    (delayed_spring, {**SPRING, "master_damping": 2, "slave_damping": 2 - HAIR}, False),
    (delayed_spring, {**SPRING, "master_damping": -3, "slave_damping": -3}, False),
    (delayed_spring, {**SPRING, "stiffness": 0, "master_damping": -NOTHING,
                      "slave_damping": 5}, False),
    (delayed_spring, {**SPRING, "master_inertia": 0, "master_damping": 0,
                      "slave_damping": 5}, False),
    (delayed_spring, {**SPRING, "delay": 0, "master_damping": 0, "slave_damping": 0}, True),
    (cancelled_inertia, {**MASS, "cancelled": 1}, True),
    (cancelled_inertia, {**MASS, "cancelled": NOTHING, "damping": 0}, False),
    (cancelled_inertia, {**MASS, "cancelled": F(1, 2), "time_constant": 0, "delay": T}, False),
    (cancelled_inertia, {**MASS, "cancelled": 1, "time_constant": 0}, True),
    (cancelled_inertia, {**MASS, "cancelled": 1 + HAIR, "time_constant": 0}, False),
    (wave_channel, {"wave_impedance": 1, "scale": F(3, 5), "delay_growth": F(16, 25)}, True),
    (wave_channel, {"wave_impedance": 1, "scale": F(3, 5) + HAIR,
                    "delay_growth": F(16, 25)}, False),
    (wave_channel, {"wave_impedance": 1, "scale": NOTHING, "delay_growth": 1}, False),
    (wave_teleoperator, {"master": S - exact(NOTHING), "slave": S + 1, "coupling": 1,
                         "wave_impedance": 1}, False),
    (wave_teleoperator, {"master": ct.tf([1, 0, -1], [1, 1, -2]), "slave": S + 1, "coupling": 1,
                         "wave_impedance": 1}, False),
    (quantised_spring, {**STEPS, "stiffness": 200}, True),
    (quantised_spring, {**STEPS, "stiffness": 200 + HAIR}, False),
    (quantised_spring, {**STEPS, "stiffness": 0, "compensator_level": F(1, 100)}, False),
    (quantised_spring, {**STEPS, "step": 0, "coulomb_level": 0, "stiffness": 2000 + HAIR}, False),
    (sampled_passivity, {**SAMPLED, "controller": sp.S(2000)}, True),
    (sampled_passivity, {**SAMPLED, "controller": 2000 + exact(HAIR)}, False),
    (sampled_passivity, {**SAMPLED, "controller": exact(NOTHING) / (Z - 2)}, False),
    (sampled_passivity, {**SAMPLED, "controller": exact(NOTHING) / (Z - 1) ** 2}, False),
    (sampled_passivity, {**SAMPLED, "controller": -exact(NOTHING) / (Z + 1)}, False),
    (sampled_passivity, {**SAMPLED, "controller": exact(NOTHING) / (Z - 1)}, False),
    (sampled_passivity, {**SAMPLED, "controller": sp.S(-100), "stiffness": 100}, True),
    (sampled_passivity, {**SAMPLED, "controller": sp.S(-100), "stiffness": 100 - HAIR}, False),
    (sampled_passivity, {**SAMPLED, "controller": sp.S(0), "stiffness": -NOTHING}, False),
    (sampled_passivity, {**SAMPLED, "controller": HIDDEN}, False),
    (sampled_coupling, {"coupling": sp.S(500), "master_damping": 1, "slave_damping": 0,
                        "sample_time": T}, False),
    (any_environment, JOINT, True),
    (any_environment, {**JOINT, "compensator_level": 1 + HAIR}, False),
    (any_environment, {**JOINT, "compensator_level": 2, "link_level": 100}, False),
]  # fmt: skip


def contradicts(ask, truth):
    """Whether what is claimed is not so."""
    try:
        status = ask().status
    except TeleopDesignError as refused:
        assert "\n" not in str(refused)
        return False
    return status == ("refuted" if truth else "proved")


@pytest.mark.parametrize(("impedance", "truth"), ONE_PORTS, ids=range(len(ONE_PORTS)))
def test_no_false_claim_is_made_on_a_port(impedance, truth):
    assert not contradicts(lambda: positive_real(impedance), truth)


@pytest.mark.parametrize(("entries", "dies", "bears"), TWO_PORTS, ids=range(len(TWO_PORTS)))
def test_no_false_claim_is_made_on_a_two_port(entries, dies, bears):
    a, b, c, d = entries
    system = two_port([[a, b], [c, d]])
    assert not contradicts(lambda: passive(system), dies)
    assert not contradicts(lambda: absolutely_stable(system), bears)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("theorem", "numbers", "truth"), NUMBERS, ids=[f"{t.__name__} {k}" for k, (t, *_) in
                                                   enumerate(NUMBERS)]
)  # fmt: skip
def test_nothing_false_is_reported_on_a_border_of_a_theorem(theorem, numbers, truth):
    assert not contradicts(lambda: theorem(**numbers), truth)


def test_many_of_these_are_decided():
    """Not all are: a hair beyond a border no motion can show in floats what numbers decide."""
    decided = [theorem(**numbers).status for theorem, numbers, truth in NUMBERS if truth]
    assert decided.count("proved") >= len(decided) - 1


def test_what_is_proved_holds_what_is_refuted_does_not_and_of_the_unknown_neither_is_reported():
    """And of evidence what its numbers say."""
    proved, refuted = positive_real(S + 2), positive_real(S - 2)
    assert (proved.status, proved.holds, proved.heading) == ("proved", True, "proved")
    assert (refuted.status, refuted.holds, refuted.heading) == ("refuted", False, "refuted")
    assert refuted.record.replay() > 0 and proved.certificates and not refuted.certificates
    with pytest.raises(TeleopDesignError, match="no motion refutes it"):
        _ = proved.record
    unknown = Claim("anything", Unknown("no reason"))
    assert (unknown.status, unknown.holds, unknown.heading) == ("unknown", None, "unknown")
    for holds, heading in ((True, "evidence"), (False, "evidence against")):
        claim = Claim("anything", Evidence(holds, "a sweep", 0.5, "N s/m"))
        assert (claim.status, claim.holds, claim.heading) == ("evidence", holds, heading)
