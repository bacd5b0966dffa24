"""What a diagnosis decides at the limits of its thresholds, each from both sides.

Fits are stand-ins that hold the numbers which a decision reads: no record is fitted here.
"""

from types import SimpleNamespace

from diagnose.stand_ins import fit, floor, ranked, rung

from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.decision import is_better, refusal
from teleopdesign.diagnose.evidence import is_adequate, is_noise, limit_noise_floor
from teleopdesign.diagnose.probability import verdict
from teleopdesign.effects import EFFECTS


def test_a_model_that_leaves_nothing_is_adequate_though_sensors_leave_nothing_too():
    """As of a simulated record that was not rounded."""
    assert is_noise(0.0, floor(0.0)) and is_adequate(fit(0.0), floor(0.0))
    assert not is_adequate(fit(1e-12), floor(0.0))


def test_a_floor_is_no_more_than_the_records_leave():
    left = SimpleNamespace(ranked=(ranked(0.3), ranked(0.2), ranked(0.1, refused="blind")))
    assert limit_noise_floor(floor(0.5), fit(0.4), left).value == 0.2
    assert limit_noise_floor(floor(0.15), fit(0.4), left).value == 0.15
    assert limit_noise_floor(floor(0.5, jitters=True), fit(0.4), left).value == 0.4


def test_what_makes_a_force_unpredictable_or_only_smaller_has_not_explained_it():
    base = fit(0.5)
    assert refusal(base, fit(0.3)) == ""
    assert refusal(base, fit(0.3, blind=0.25)) == ""
    assert refusal(base, fit(0.3, blind=0.26)) == "blind"
    # a base that is blind itself bars what makes it a quarter more so
    assert refusal(fit(0.5, blind=0.3), fit(0.3, blind=0.5)) == ""
    assert refusal(fit(0.5, blind=0.3), fit(0.3, blind=0.56)) == "blind"
    assert refusal(fit(0.5, blind=0.2), fit(0.3, blind=0.26)) == "blind"
    # three hundredths of the squares: less of the force, and no less at the command
    assert refusal(base, fit(0.5 * 0.96**0.5, at_command=0.5)) == "hides"
    assert refusal(base, fit(0.5 * 0.98**0.5, at_command=0.5)) == ""


def test_the_verdict_names_effects_unless_all_of_them_look_alike():
    one = Candidate(EFFECTS["stribeck"], "device")
    assert verdict([rung(0.18)], floor()) == "model_adequate"
    assert verdict([rung(0.19)], floor()) == "undecided"
    assert verdict([rung(0.5), rung(0.2, one)], floor()) == "effects_missing"
    assert verdict([rung(0.5), rung(0.2, one, (one,))], floor()) == "undecided", "all look alike"
    two = [rung(0.5), rung(0.3, one, (one,)), rung(0.2, one)]
    assert verdict(two, floor()) == "effects_missing"


def test_of_no_error_at_all_nothing_is_less():
    """As of a still record whose force is a power of two."""
    assert not is_better(fit(0.0), fit(0.0), floor(0.0))
    assert not is_better(fit(0.0), fit(0.1), floor(0.0))
    assert is_better(fit(0.1), fit(0.0), floor(0.0))
