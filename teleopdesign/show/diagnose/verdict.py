"""The verdict of a diagnosis in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...base.sentences import percent
from ...diagnose.noise_floor import say_floors
from ...diagnose.ranking import REFUSALS

if TYPE_CHECKING:
    from ...diagnose.diagnosis import Diagnosis
    from ...diagnose.statements import LadderRow, NotAccepted


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict of a diagnosis in words; what is left of an arm is said of each joint."""
    if diagnosis.joints:
        names = ", ".join(map(str, diagnosis.missing))
        why = f" {diagnosis.silence}" if diagnosis.silence else ""
        return f"verdict: {diagnosis.verdict}{': ' + names if names else ''}.{why}"
    rest = _rest(diagnosis)
    if diagnosis.verdict == "model_adequate":
        noise = f" The remaining error is noise ({diagnosis.left:.2f} noise floors)."
        return f"verdict: model_adequate.{rest or noise}"
    if diagnosis.verdict == "effects_missing":
        return f"verdict: effects_missing: {_named_effects(diagnosis)}{rest}"
    left, added = say_floors(diagnosis.left), [r for r in diagnosis.rungs if r.added is not None]
    names = ", ".join(r.title for r in added)
    if diagnosis.either and diagnosis.unlikely:
        return f"verdict: undecided.{_not_named(diagnosis, first='')}{rest}"
    if diagnosis.unlikely:
        return (
            f"verdict: undecided, leading candidate {names}: less likely than not, because "
            f"{_why_unlikely(diagnosis) or f'{left} noise floors are left'}."
        )
    if diagnosis.groups:
        names = "; ".join(" or ".join(map(str, g)) for g in diagnosis.groups)
        return f"verdict: undecided, {names}: these records do not decide.{rest}"
    if diagnosis.silence:
        return f"verdict: undecided. {diagnosis.silence}"
    which = "effect that may be named" if diagnosis.not_accepted else "candidate effect"
    return (
        f"verdict: undecided. No {which} explains the {left} noise floors that are left."
        f"{_nearest(diagnosis)}"
    )


def _why_unlikely(diagnosis: Diagnosis) -> str:
    """The free function that explains more than an accepted effect does; "": none is known."""
    compared = [c for c in diagnosis.candidates if c.rho is not None and c.rho < 1.0]
    if not compared:
        return ""
    one = min(compared, key=lambda c: c.rho or 0.0)
    rho = one.rho or 0.0
    times = f"{1.0 / rho:.2g} times as much as" if rho > 0.1 else "far more than"
    return f"a free function of {one.free_function} explains {times} {one.candidate}"


def _named_effects(diagnosis: Diagnosis) -> str:
    """The effects that are missing, and those that are less likely than not, as a sentence."""
    named = [r for r in diagnosis.rungs if r.added is not None and r.added in diagnosis.missing]
    return f"{', '.join(map(_with_look_alikes, named))}.{_not_named(diagnosis)}"


def _not_named(diagnosis: Diagnosis, *, first: str = "Also ") -> str:
    """Sentences on accepted effects that are not named: one of several, or less likely than not."""
    text = ""
    for row in diagnosis.either:
        text += f" {first}{_with_look_alikes(row)} is missing: these records do not decide which."
        first = "Also "
    rest = [r for r in diagnosis.rungs if r.added is not None]
    rest = [r for r in rest if r.added not in diagnosis.missing and r not in diagnosis.either]
    if not rest:
        return text
    describe = "this effect describes" if len(rest) == 1 else "these effects describe"
    return (
        f"{text} {', '.join(r.title for r in rest)}: less likely than not; the force that "
        f"{describe} counts as unexplained."
    )


def _with_look_alikes(row: LadderRow) -> str:
    return " or ".join((row.title, *(str(one.candidate) for one in row.alternatives)))


def _rest(diagnosis: Diagnosis) -> str:
    """A sentence on what is left above noise; "": only noise is left."""
    left = say_floors(diagnosis.left)
    if not diagnosis.more_is_missing:
        return ""
    return f" The remaining error is {left} noise floors: more is missing.{_nearest(diagnosis)}"


def _nearest(diagnosis: Diagnosis) -> str:
    """Sentences on the candidates with the least errors where none is supported; "": none helps.

    One is refused for its influence on the command, although it leaves less of that force as well.
    """
    near, text = diagnosis.nearest, ""
    refused = [c for c in diagnosis.not_accepted if c.reason in REFUSALS.values()]
    least = min(refused, key=_larger_error, default=None)
    limit = diagnosis.after.check_error if near is None else near.check_error
    if least is not None and _larger_error(least) < limit:
        size = percent(_larger_error(least), ".3g")
        text = f" {least.candidate} would leave {size} and is refused: {least.reason}."
    if near is None:
        return text
    return (
        f"{text} {near.candidate} comes nearest and would leave "
        f"{percent(near.check_error, '.3g')}: "
        f"{near.reason or 'on these records this may be chance'}."
    )


def _larger_error(candidate: NotAccepted) -> float:
    """The larger of its errors, of the acting force and of the command; inf: one is not known."""
    errors = (candidate.check_error, candidate.check_error_at_command)
    return math.inf if any(map(math.isnan, errors)) else max(errors)
