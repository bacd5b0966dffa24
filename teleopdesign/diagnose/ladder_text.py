"""A diagnosis in words: the ladder as a table, and the verdict as a sentence."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..quantity import unit_of
from .fit import Fit
from .ranking import REFUSALS
from .record_offsets import offset_groups

if TYPE_CHECKING:
    from .diagnosis import Diagnosis


def offset_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Offsets of single records by the final model of the diagnosis."""
    stretches, rows = diagnosis.prepared.stretches, []
    for group, offsets in offset_groups(diagnosis.model, stretches):
        motion = stretches[group[0]].motion
        units = {
            "position_zero": unit_of("position", offsets.body.axis),
            "bias": unit_of("force", offsets.body.axis),
            "friction_level": "of the model's",
        }
        rows += [
            {"record": motion.file, "at": motion.body, "of": n, "value": v, "unit": units[n]}
            for n, v in offsets.values.items()
        ]
    return rows


def _number(value: float, error: float, unit: str) -> str:
    if math.isfinite(error) and error > 0:
        return f"{value:.4g} +- {error:.1g} {unit}"
    return f"{value:.4g} {unit}"


#: part of the error from which the one seen at the command is told beside it
DIFFERENT = 0.02


def command_error_text(fit: Fit) -> str | None:
    """The error at the command and the blind share, if they differ from the check error."""
    command_error = fit.at_command
    alike = abs(command_error.error - fit.check_error) <= DIFFERENT * fit.check_error
    if alike and command_error.blind == 0.0:
        return None
    blind = (
        f", blind in {100 * command_error.blind:.2g} % of the motion" if command_error.blind else ""
    )
    return f"check error seen at the command: {_percent(command_error.error)}{blind}"


def _percent(error: float) -> str:
    """An error in percent; unknown for a model that is blind everywhere."""
    return f"{100 * error:.2f} %" if math.isfinite(error) else "not told"


def refused_lines(diagnosis: Diagnosis) -> list[str]:
    """Candidates with a smaller force error than the final model, and why they do not count."""
    after = diagnosis.after
    return [
        f"refused: {r.candidate} ({_percent(r.fit.check_error)}; seen at the command "
        f"{_percent(r.fit.at_command.error)}): {REFUSALS[r.refused]}"
        for r in diagnosis.last.ranked
        if r.refused and r.fit.check_error < after.check_error
    ]


def ladder_text(diagnosis: Diagnosis) -> str:
    """The ladder as a table, with parameters, noise floor and verdict."""
    lines = [f"{'added':<42}{'fit error':>10}{'check error':>13}"]
    for rung in diagnosis.rungs:
        name = "(your model, re-estimated)" if rung.added is None else f"+ {rung.added}"
        lines.append(
            f"{name:<42}{100 * rung.fit.fit_error:>9.2f}%{100 * rung.fit.check_error:>12.2f}%"
        )
        if rung.added is None:
            continue
        model = diagnosis.model
        for p in rung.added.effect.parameters:
            full = f"{rung.added.at}.{rung.added.effect.name}.{p}"
            value = model.parameters[full]
            bound = "  at its bound" if full in diagnosis.after.at_bound else ""
            lines.append(
                f"      {p} = {_number(value.value, value.stderr, model.unit(full))}{bound}"
            )
        if (text := command_error_text(rung.fit)) is not None:
            lines.append(f"      {text}")
        if rung.alternatives:
            others = ", ".join(map(str, rung.alternatives))
            lines.append(f"      no different on these records: {others}")
    lines += [
        f"own of {o['record']}: {o['of'].replace('_', ' ')} {o['value']:.4g} {o['unit']}"
        for o in offset_rows(diagnosis)
    ]
    lines.append(
        f"{'noise floor':<42}{'':>10}{100 * diagnosis.floor.value:>12.2f}%"
        f"  ({diagnosis.floor.source})"
    )
    lines += refused_lines(diagnosis)
    lines.append("")
    lines.append(sentence(diagnosis))
    return "\n".join(lines)


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict in words."""
    left = diagnosis.left
    more = f" What is left is {left:.1f} noise floors: more is missing."
    rest = more if diagnosis.more_is_missing else ""
    if (moment := diagnosis.moment) is not None:
        rest = (
            f" What is left is {left:.1f} noise floors, but {moment.without:.1f} without one "
            f"moment ({moment})."
        )
    if diagnosis.verdict == "model_adequate":
        noise = f" What is left is noise ({left:.2f} noise floors)."
        return f"verdict: model_adequate.{rest or noise}"
    if diagnosis.verdict == "effects_missing":
        equals = {r.added: r.alternatives for r in diagnosis.rungs if r.added is not None}
        names = ", ".join(" or ".join(map(str, (c, *equals[c]))) for c in diagnosis.missing)
        less = [str(c) for c in equals if c not in diagnosis.missing]
        others = f" {', '.join(less)}: less likely than not." if less else ""
        return f"verdict: effects_missing: {names}.{others}{rest}"
    if diagnosis.unlikely:
        names = ", ".join(str(r.added) for r in diagnosis.rungs if r.added is not None)
        return (
            f"verdict: undecided. What helps most ({names}) is less likely than not what is "
            f"missing: {left:.1f} noise floors are left."
        )
    if len(diagnosis.rungs) > 1 and any(r.added and not r.alternatives for r in diagnosis.rungs):
        names = ", ".join(str(r.added) for r in diagnosis.rungs if r.added is not None)
        return (
            f"verdict: undecided. {names} help, but explain less than half of what is missing: "
            f"{left:.1f} noise floors are left."
        )
    if diagnosis.groups:
        names = "; ".join(" or ".join(map(str, g)) for g in diagnosis.groups)
        return f"verdict: undecided between {names}: these records cannot tell.{rest}"
    return (
        f"verdict: undecided. No effect tried explains the {left:.1f} noise floors that are left."
    )
