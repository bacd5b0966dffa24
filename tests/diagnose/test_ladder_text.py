"""What a diagnosis says of an error in noise floors."""

from types import SimpleNamespace

import pytest
from diagnose.stand_ins import fit, floor, ranked

from teleopdesign.diagnose.open_questions import nearest, not_accepted, possible_next
from teleopdesign.show.diagnose import text as ladder_text
from teleopdesign.show.diagnose.text import records_line, say_floors
from teleopdesign.show.report.words import _floors


@pytest.mark.parametrize(("left", "message"), [(0.94, "0.9"), (45.34, "45.3"), (1000.0, "1000.0")])
def test_an_error_is_a_number_of_noise_floors(left, message):
    assert say_floors(left) == message


@pytest.mark.parametrize("left", [1000.1, 744440815.1, float("inf")])
def test_a_floor_next_to_zero_is_no_measure(left):
    """Where the force has no stated noise, the floor is that of the position alone."""
    assert say_floors(left) == _floors(left) == "more than 1000"


@pytest.mark.parametrize(
    ("refused", "words"),
    [
        ([], "No candidate effect"),
        (["refused: x"], "No effect that may be named"),
    ],
)
def test_where_effects_are_refused_no_effect_that_may_be_named_explains_the_rest(refused, words):
    """The sentence stood below a list of refused effects that would explain all of it."""
    diagnosis = SimpleNamespace(
        verdict="undecided", left=8.0, more_is_missing=True,
        unlikely=False, rungs=[SimpleNamespace(added=None)], groups=(), silence="", nearest=None,
        not_accepted=refused,
    )  # fmt: skip
    assert f"{words} explains the 8.0 noise floors" in ladder_text.sentence(diagnosis)


@pytest.mark.parametrize(
    ("open_error", "more", "message"),
    [
        (0.2, {}, True),
        (0.5, {}, False),  # another candidate leaves less
        (0.79, {"counted": 0.9}, False),  # it takes away too little to matter
        (0.2, {"more_is_missing": False}, False),
        (0.2, {"implausible": "its gap is no gap"}, False),  # refused for that
    ],
)
def test_a_candidate_whose_values_stay_open_is_reported_where_none_that_counts_leaves_less(
    open_error, more, message
):
    """ "Comes nearest" names the best candidate that counts; one that left less was not listed."""
    reason = more.get("implausible", "")
    rows = [
        ranked(more.get("counted", 0.4)),
        ranked(open_error, "spring", is_identifiable=False, implausible=reason),
    ]
    diagnosis = SimpleNamespace(
        last=SimpleNamespace(ranked=rows, base=fit(0.8)),
        after=fit(0.8),
        floor=floor(),
        more_is_missing=more.get("more_is_missing", True),
    )
    rows = [one for one in not_accepted(diagnosis) if one.why == "not determined"]
    lines = ladder_text._lines_not_accepted(SimpleNamespace(not_accepted=rows))
    assert lines == (
        [
            "not determined: spring at device leaves least (20.00 %), but these records do not "
            "determine its values"
        ]
        if message
        else []
    )


@pytest.mark.parametrize("check", [(), ("a stretch",)])
def test_without_check_records_the_machine_was_not_another_one_in_them(check):
    """Of one stroke of a joint, "the machine was not the same in both" records was said."""
    diagnosis = SimpleNamespace(
        after=SimpleNamespace(fit_error=0.2, check_error=0.7),
        on_all_records=None,
        held_out=not check,
    )
    line = records_line(diagnosis)
    assert "3.5 times that on the fit" in line
    assert ("the machine was not the same in both" in line) == bool(check)
    assert ("blocks that are left out of the fit" in line) != bool(check)


def test_a_candidate_that_a_rule_refuses_does_not_come_nearest():
    """Of a joint in one stroke, friction with its amplitude at a bound was "refused", and "comes
    nearest" below."""
    rows = [ranked(0.1, "position_dependent_friction"), ranked(0.4, "stribeck")]
    rows[0].fit.at_bound = ("device.position_dependent_friction.amplitude",)
    rows[0].fit.model.declared = lambda name: SimpleNamespace(optional=False)
    for row in rows:
        row.fit.model.absent = ()
    last = SimpleNamespace(ranked=rows, base=fit(0.8))
    possible = possible_next(SimpleNamespace(last=last, floor=floor(0.05)))
    assert [r.candidate.effect.name for r in possible] == ["stribeck"]
    rows[0].fit.at_bound = ()
    assert len(possible_next(SimpleNamespace(last=last, floor=floor(0.05)))) == 2


@pytest.mark.parametrize(
    ("left", "listed", "reason", "sentence"),
    [
        (0.05, False, "", "would leave 5 %: on these records this may be chance."),
        (0.05, False, "at a bound", "would leave 5 %: at a bound."),
        (0.0999, False, "", ""),
        (0.05, True, "", ""),
    ],
)
def test_the_candidate_that_comes_nearest_is_named_where_it_helps_and_is_not_listed_before(
    left, listed, reason, sentence
):
    spring, bias = ranked(left, "spring"), ranked(0.3, "bias")
    for row in (spring, bias):
        row.fit.model.absent = ()
    alike = (spring.candidate,) if listed else ()
    end = SimpleNamespace(
        rungs=[SimpleNamespace(added=bias.candidate, alternatives=alike)],
        last=SimpleNamespace(ranked=[spring], base=fit(0.1)),
        after=fit(0.1),
        floor=floor(0.01),
        reason_set_aside=lambda key: reason,
    )
    text = ladder_text._nearest(SimpleNamespace(nearest=nearest(end)))
    assert text.endswith(sentence) and bool(text) == bool(sentence)
