"""Verdicts in words, as a report prints them."""

from __future__ import annotations

from ...base.sentences import join_names
from ...base.sentences import number_on_page as number
from ...base.sentences import percent_on_page as percent
from ...diagnose.criteria import CRITERIA
from ...diagnose.diagnosis import Diagnosis
from ...diagnose.statements import LadderRow
from ...measurement.experiment import Experiment


def sentence_of(entry: object | None) -> str:
    """The text of an entry of a diagnosis as a sentence; "" without an entry."""
    text = "" if entry is None else str(entry)
    return f"{text[:1].upper()}{text[1:]}." if text else ""


def step_name(rung: LadderRow) -> str:
    """The effect that a row adds, with equally good ones: "stribeck at device"."""
    if rung.added is None:
        return "your model, re-estimated"
    return " or ".join((rung.title, *(str(one.candidate) for one in rung.alternatives)))


def describe_judgement(experiment: Experiment) -> str:
    """The records on which the errors are reported."""
    if experiment.check_records:
        return "records that were not fitted"
    return "blocks of the records that were held out of the fit"


def _floors(left: float) -> str:
    """An error in noise floors; no number where the floor is next to zero."""
    return number(left, 2) if left <= CRITERIA.countable else f"more than {CRITERIA.countable:g}"


def verdict(diagnosis: Diagnosis) -> str:
    """The verdict in one or two sentences."""
    if diagnosis.joints:
        return _verdict_on_arm(diagnosis)
    before, after = diagnosis.before.check_error, diagnosis.after.check_error
    floor, left = percent(diagnosis.floor.value), _floors(diagnosis.left)
    fell = f"the force error on {describe_judgement(diagnosis.experiment)} falls from "
    fell += f"{percent(before)} to {percent(after)}"
    added = [step_name(r) for r in diagnosis.rungs if r.added is not None]
    more = diagnosis.more_is_missing
    rest = (
        f"The remaining error is {left} times what sensor noise alone would leave: more is missing."
        if more
        else f"The remaining error is near what sensor noise alone would leave, {floor}."
    )
    if diagnosis.verdict == "model_adequate":
        return (
            f"Your model is adequate: it leaves {percent(after)} of the force unexplained, and "
            f"sensor noise alone would leave {floor}."
        )
    if diagnosis.verdict == "effects_missing":
        named = [step_name(r) for r in diagnosis.rungs if r.added in diagnosis.missing]
        less = [step_name(r) for r in diagnosis.rungs[1:] if r.added not in diagnosis.missing]
        helps = "helps, but is" if len(less) == 1 else "help, but each is"
        others = f" {join_names(less)} {helps} less likely than not." if less else ""
        added_words = "this effect" if len(added) == 1 else "all added effects"
        return f"Your model lacks {join_names(named)}. With {added_words}, {fell}.{others} {rest}"
    if diagnosis.silence:
        return f"Undecided. {diagnosis.silence}"
    if not added:
        return (
            "Undecided: something is missing, but no candidate effect explains the remaining "
            f"force. The force error is {percent(after)}, {left} times what sensor noise alone "
            "would leave."
        )
    if all(r.alternatives for r in diagnosis.rungs[1:]):
        names = join_names(added)
        return f"Undecided, {names}: these records do not decide. Either way {fell}. {rest}"
    each = "it is" if len(added) == 1 else "each is"
    return f"Undecided: with {join_names(added)} {fell}, but {each} less likely than not. {rest}"


def _verdict_on_arm(diagnosis: Diagnosis) -> str:
    """The verdict on an arm; that on each joint stands in the part of the joint."""
    before, after = percent(diagnosis.before.check_error), percent(diagnosis.after.check_error)
    where = describe_judgement(diagnosis.experiment)
    if diagnosis.verdict == "model_adequate":
        return (
            f"Your model of the arm is adequate: it leaves {after} of the forces unexplained on "
            f"{where}."
        )
    fell = f"the force error on {where} falls from {before} to {after}"
    if diagnosis.verdict == "effects_missing":
        names = join_names([str(c) for c in diagnosis.missing])
        return f"Your model of the arm lacks {names}. With all that was added {fell}."
    if len(diagnosis.rungs) > 1:
        added = join_names([r.title for r in diagnosis.rungs[1:]])
        return f"Undecided: with {added} {fell}, but these records do not show what is missing."
    return f"Undecided: something is missing, but no candidate effect explains the {after}."
