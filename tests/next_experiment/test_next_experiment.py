"""What is proposed keeps to limits, separates what can be separated, and is honest where none can.

The proof runs on a simulator that shares nothing with the package: it runs the proposed reference.
"""

import numpy as np
import pytest
from next_experiment.next_cases import POOR, RATE

from teleopdesign import Model, find_missing
from teleopdesign.base.errors import ModelError
from teleopdesign.effects import EFFECTS
from teleopdesign.next_experiment import (
    propose,
    show_in_simulation,
    shown_limits,
    write_reference,
)
from teleopdesign.next_experiment.prediction import refit, with_records

pytestmark = pytest.mark.slow  # motions are optimised

FEW = {n: EFFECTS[n] for n in ("coulomb", "viscous", "quadratic_drag", "bias", "coulomb_asymmetry")}


def diagnosed(experiment, known):
    return find_missing(experiment, Model.from_experiment(experiment, known))


def number_of(proposal, effect):
    return [r.candidate.effect.name for r in proposal.rivals].index(effect)


@pytest.fixture(scope="module")
def one_speed(tmp_path_factory):
    """Rod with quadratic drag, recorded at one speed; what is proposed for it."""
    rod, experiment = POOR["one speed"].experiment(tmp_path_factory.mktemp("next") / "drag", 1)
    return rod, experiment, propose(diagnosed(experiment, FEW))


# the motion


def test_the_motion_keeps_within_the_limits_that_the_records_have_shown(one_speed):
    _, _, proposal = one_speed
    limits = proposal.limits["device"]
    signals = [proposal.reference.position["device"]]
    for _ in range(3):
        signals.append(np.gradient(signals[-1], 1 / RATE))
    # numbers are rounded in the last places alone
    assert signals[0].min() >= limits.low - 1e-9 and signals[0].max() <= limits.high + 1e-9
    for signal, name in zip(signals[1:], ("speed", "acceleration", "jerk"), strict=True):
        assert np.abs(signal).max() <= 1.001 * getattr(limits, name)


def test_the_reference_is_written_with_header_units_and_sample_time_of_the_experiment(
    one_speed, tmp_path
):
    _, experiment, proposal = one_speed
    write_reference(proposal.reference, experiment, tmp_path / "next.csv")
    head = (tmp_path / "next.csv").read_text().splitlines()[0]
    table = np.loadtxt(tmp_path / "next.csv", delimiter=",", skiprows=1)
    assert head == "clock,place"  # ms and mm
    assert np.diff(table[:, 0]) == pytest.approx(1.0)
    assert table[:, 1] == pytest.approx(1e3 * proposal.reference.position["device"], abs=1e-6)


# what it shows


def test_rivals_are_what_the_records_leave_open(one_speed):
    _, _, proposal = one_speed
    assert {r.candidate.effect.name for r in proposal.rivals} == {"viscous", "quadratic_drag"}
    assert all(s.present < 1.0 for s in proposal.separations)
    assert all(s.predicted > 2.0 * s.present for s in proposal.separations)
    assert all(proposal.decides(p) for p in [(0, 1)])
    # whichever of the two is said first
    assert "if quadratic_drag at device is right, viscous at device" in proposal.sentence.lower()


def test_the_predicted_separation_holds_on_an_independent_simulator(one_speed):
    rod, _, proposal = one_speed
    new = rod.records(proposal.reference.position["device"])
    after = refit(proposal.rivals, new, proposal.bench)
    truth, other = number_of(proposal, "quadratic_drag"), number_of(proposal, "viscous")
    (predicted,) = (
        s.predicted
        for s in proposal.separations
        if s.truth is proposal.rivals[truth] and s.other is proposal.rivals[other]
    )
    # the servo follows the reference in a way of its own, and chance takes part
    assert after.separation(truth=truth, other=other) == pytest.approx(predicted, rel=0.4)
    assert after.separation(truth=other, other=truth) == 0.0


def test_no_motion_distinguishes_two_laws_that_need_the_same_force(tmp_path):
    _, experiment = POOR["one place"].experiment(tmp_path / "bias", 1)
    proposal = propose(diagnosed(experiment, FEW))
    assert {r.candidate.effect.name for r in proposal.rivals} == {"bias", "coulomb_asymmetry"}
    # the two differ in nothing but rounding, along any motion and with any change of the set-up
    assert all(s.predicted < 1e-3 for s in proposal.separations)
    remedy = proposal.remedies[0, 1]
    assert len(remedy) >= 6 and all(r.separation < 1e-3 for r in remedy)
    assert "only knowledge of the device can say" in proposal.sentence
    assert not proposal.is_useful and "follow the reference" not in proposal.sentence


def test_where_the_records_decide_nothing_is_proposed(diagnosis):
    proposal = propose(diagnosis)
    assert proposal.reference is None and not proposal.rivals
    assert proposal.findings()[0].concern == "fine"
    assert "decide" in proposal.sentence


# what the user says


def test_limits_of_the_user_are_kept_and_wrong_ones_refused(one_speed):
    _, _, proposal = one_speed
    shown = shown_limits(proposal.diagnosis.prepared)["device"]
    slow = shown.with_values(speed=0.5 * shown.speed, high=0.5 * shown.high)
    kept = propose(proposal.diagnosis, limits={"device": slow}, duration=10.0)
    x = kept.reference.position["device"]
    assert np.abs(np.diff(x)).max() * RATE <= 1.001 * slow.speed
    assert x.max() <= slow.high + 1e-9
    with pytest.raises(ModelError, match='no limit "sped".*did you mean "speed"'):
        shown.with_values(sped=1.0)
    with pytest.raises(ModelError, match='no body "devise".*did you mean "device"'):
        propose(proposal.diagnosis, limits={"devise": shown})
    with pytest.raises(ModelError, match="speed is -1, expected more than 0"):
        shown.with_values(speed=-1.0)


# the proof: every kind of poor records, the whole diagnosis


def known_of(poor):
    """Effects to choose from: the time of a search grows with the square of their number."""
    usual = ("coulomb", "viscous", "quadratic_drag", "bias", "spring", *poor.rivals)
    return {n: EFFECTS[n] for n in dict.fromkeys(usual)}


def proposed(case, number, folder):
    poor = POOR[case]
    rod, experiment = poor.experiment(folder, number)
    diagnosis = diagnosed(experiment, known_of(poor))
    wider = {b: limits.widen(poor.wider) for b, limits in shown_limits(diagnosis.prepared).items()}
    return poor, rod, experiment, propose(diagnosis, limits=wider)


def test_what_is_predicted_is_measured_and_then_named(tmp_path):
    """A spring, which the first records alone called the other one."""
    case, number = "one place", 0
    poor, rod, experiment, proposal = proposed(case, number, tmp_path / "case")
    truth, other = (number_of(proposal, poor.rivals[i]) for i in (number, 1 - number))
    new = rod.records(proposal.reference.position["device"])
    after = refit(proposal.rivals, new, proposal.bench)
    (predicted,) = (
        s.predicted
        for s in proposal.separations
        if s.truth is proposal.rivals[truth] and s.other is proposal.rivals[other]
    )
    separation = after.separation(truth=truth, other=other)
    # found over predicted lay between 0.4 and 1.1 when this was written; the servo is not known
    assert 0.3 * predicted < separation < 2.0 * predicted
    again = diagnosed(with_records(experiment, new), known_of(poor))
    named = {c.effect.name for c in (*again.missing, *(c for g in again.groups for c in g))}
    if predicted >= 1.0:
        assert poor.rivals[number] in named and poor.rivals[1 - number] not in named


def test_without_a_scale_of_force_a_sensor_is_asked_for_not_a_motion(tmp_path):
    """Inertia fixed, no interaction force: a body more and a gain need the same commands."""
    poor, _, _, proposal = proposed("no scale of force", 0, tmp_path / "case")
    pair = tuple(sorted(number_of(proposal, name) for name in poor.rivals))
    assert not proposal.decides(pair)
    helping = [r.change for r in proposal.remedies[pair] if r.separation >= 1.0]
    assert any("a hand pushes the device" in change for change in helping)
    assert not any("larger" in change or "finer" in change for change in helping)


def test_each_rival_is_named_when_it_is_made_the_truth(one_speed):
    _, _, proposal = one_speed
    shown = show_in_simulation(proposal)
    assert [s.named for s in shown] == [True, True]
    assert show_in_simulation(proposal, seconds=-1.0) == ()
