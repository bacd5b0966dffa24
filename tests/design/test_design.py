"""A design: sure to be passive, predictions that agree where they should, answers read back."""

import tomllib

import numpy as np
import pytest

import teleopdesign as td
from teleopdesign.base.errors import ModelError
from teleopdesign.blocks import Body, Value
from teleopdesign.design import Assumptions, design
from teleopdesign.design.assumptions import StatedMotion
from teleopdesign.design.device import Device
from teleopdesign.design.other_effects import with_forces
from teleopdesign.design.propose import cancellations
from teleopdesign.design.quasi_static import quasi_static_error, slow_output
from teleopdesign.diagrams import haptic_interface, world_haptics_2005

pytestmark = pytest.mark.slow  # a diagnosis of a whole case


def with_effect(diagnosis, name, values):
    """The diagnosed rod with one effect more, its values taken as exact."""
    return diagnosis.with_final_model(diagnosis.model.with_effect(name, values=values))


def test_the_cancelled_level_is_below_every_level_in_the_interval(designed):
    level = designed.cancellation.controller.names()[f"{designed.cancellation.law}.level"]
    assert level <= 0.9 * (0.548 - 1.96 * 5e-4)
    assert designed.friction.lowest.estimate == pytest.approx(0.548, rel=1e-6)


def test_passivity_of_the_cancellation_is_proved_with_a_certificate(designed):
    proof = designed.claims["MBC"][0]
    assert proof.status == "proved"
    assert proof.certificates


def test_late_force_feedback_gives_out_energy(designed):
    """Cancellation takes energy in every motion tried; behind a 20 Hz low-pass H does not."""
    for case, holds in (("none", True), ("MBC", True), ("FF", False), ("hybrid", False)):
        claim = designed.claims[case][-1]
        assert claim.status == "evidence"
        assert claim.holds is holds
        assert (claim.verdict.margin > 0) is holds


def test_compensation_leaves_less_force_error_in_this_order(designed):
    left = {case: p.simulated for case, p in designed.prediction.cases.items()}
    assert left["hybrid"] < left["FF"] < left["none"]
    assert left["hybrid"] < left["MBC"] < left["none"]


def test_predictions_agree_where_nothing_is_compensated(designed):
    """Nothing is sampled there, so slow motion with inertia is the whole of it."""
    none = designed.prediction.cases["none"]
    # the contact gives by a millionth of the amplitude before it slides
    assert none.simulated == pytest.approx(none.quasi_static, rel=0.005)
    # a damper of equal loss has no third harmonic: 1/sqrt(1 + 1/9 + ..) = 0.90 of Coulomb's rms
    assert 0.85 < none.linear / none.simulated < 1.0


def test_the_quasi_static_error_is_p13_for_coulomb_friction():
    """r(v) = F_C a (b + v)/((a + v)(b + v + k b)) without inertia, at the paper's readings."""
    diagram = world_haptics_2005().with_values({"Z_M.inertia": 0.0})
    motion = StatedMotion(0.0, 0.01, 1.5)
    error = quasi_static_error(diagram, motion, rows=200)
    v = np.abs(motion.cycle(200)[2])
    a, b, k, level = 0.015, 0.08, 5.0, 0.5
    expected = level * a * (b + v) / ((a + v) * (b + v + k * b))
    assert np.abs(error) == pytest.approx(expected, rel=1e-9)


def test_presliding_allows_a_dahl_cancellation_only_and_softer(rod):
    diagnosis = with_effect(rod, "presliding", {"stiffness": 4000.0})
    made = design(diagnosis, assumptions=Assumptions(delay=1e-4))
    assert made.cancellation.law == "dahl"
    stiffness = made.cancellation.controller.names()["dahl.stiffness"]
    level = made.cancellation.controller.names()["dahl.level"]
    # P44: against the largest level that friction may take
    assert stiffness**2 / level <= 4000.0**2 / made.friction.highest.high
    assert [c.status for c in made.claims["MBC"][:2]] == ["proved", "proved"]
    assert made.other is None


def test_linear_theory_has_the_spring_that_is_cancelled(rod):
    """With the part of C for friction alone, it stated the error of a spring that is not there."""
    mbc = design(with_effect(rod, "spring", {"stiffness": 200.0})).prediction.cases["MBC"]
    assert mbc.linear == pytest.approx(mbc.quasi_static, rel=0.25)


def test_a_held_command_is_late_by_its_sample_too(rod):
    """With the computing delay alone, 2 um at 202 Hz took energy out of such a device."""
    diagnosis = with_effect(rod, "presliding", {"stiffness": 4000.0})
    made = design(diagnosis, assumptions=Assumptions(sample_period=1e-3, delay=3e-3))
    stiffness = made.cancellation.controller.names()["dahl.stiffness"]
    damping = Device(made.body, made.reach, made.assumptions).damping
    assert 0.9 * damping < 0.2172 * stiffness * 4e-3 <= damping


def test_friction_that_may_be_none_is_not_cancelled(unsure):
    assert unsure.cancellation is None
    cases = unsure.prediction.cases
    assert cases["MBC"].simulated == cases["none"].simulated
    assert any("No cancellation is proposed" in n for n in unsure.notes)
    assert "C" not in tomllib.loads(unsure.to_toml())["blocks"]


def test_an_actuator_that_gives_more_is_commanded_less(rod, designed):
    """Force that acts is command times gain: C divides the identified gain out."""
    body = with_effect(rod, "actuator_gain", {"gain": 1.25}).model.body("device")
    strong, device = (
        Device(b, designed.reach, designed.assumptions) for b in (body, designed.body)
    )
    speeds = np.array([0.01, 0.1, -0.2])
    pairs = zip(cancellations(strong), cancellations(device), strict=True)
    for one, reference in pairs:
        whole = with_forces(one, strong)
        commanded = slow_output(whole.controller, np.zeros(3), speeds)
        wanted = slow_output(reference.controller, np.zeros(3), speeds)
        # levels are rounded down to three digits
        np.testing.assert_allclose(commanded, wanted / 1.25, rtol=0.005)


def test_a_motion_beyond_the_records_is_refused(rod):
    with pytest.raises(ModelError, match="leaves the recorded travel"):
        design(rod, assumptions=Assumptions(amplitude=1.0))
    with pytest.raises(ModelError, match="recorded are at most"):
        design(rod, assumptions=Assumptions(amplitude=0.01, frequency=50.0))


def test_a_dahl_cancellation_equals_a_damper_in_linear_theory():
    """Of a compensator that slides fully, the damper of equal loss: 4 f/(pi V)."""
    from teleopdesign.controllers import controller
    from teleopdesign.design.linear import linear_cases

    body = Body("prismatic", {"inertia": Value(0.2), "viscous.damping": Value(50.0)},
                (td.EFFECTS["viscous"],))  # fmt: skip
    motion = StatedMotion(0.0, 0.02, 1.0)
    made = haptic_interface(body, cancellation=controller("dahl", {"level": 0.5, "stiffness": 1e6}))
    factor = linear_cases(made, motion)["MBC"].values["Z_M.viscous.damping"]
    assert 50.0 - factor == pytest.approx(4 * 0.5 / (np.pi * motion.peak_speed), rel=1e-3)


def test_the_impedance_that_a_hand_feels_is_predicted_and_lowered(designed):
    felt = designed.impedance
    assert felt.missing == ()
    simulated, predicted = felt.simulated.decibel, felt.predicted.decibel
    # describing functions take controllers for continuous: 1 dB at ten times the frequency
    assert float(abs(simulated - predicted).max()) < 1.5
    assert float(abs(simulated.sel(case="none") - predicted.sel(case="none")).max()) < 0.2
    slowest = simulated.isel(frequency=0)
    assert float(slowest.sel(case="hybrid")) < float(slowest.sel(case="FF")) - 3
    assert float(slowest.sel(case="FF")) < float(slowest.sel(case="none")) - 3


def test_an_uncertain_level_widens_the_band_of_the_felt_impedance(designed, unsure):
    sure, wide = (one.impedance.predicted.band for one in (designed, unsure))
    # friction is most of the force of slow motion: the band there is that of the level
    level = unsure.body.parameters["coulomb.level"]
    least = 20 * np.log10(1 + 0.5 * 1.96 * level.stderr / level.value)
    assert least < wide.decibel[0, 0] < 3 * least
    assert sure.decibel[0, 0] < 0.1 * wide.decibel[0, 0]
    cell = unsure.as_dict()["felt_impedance"]["predicted"]["none"]["95 %"]
    assert cell["decibel"] == pytest.approx(wide.decibel[0].tolist())
    assert "95 % of the estimates" in str(unsure)
