"""A diagnosis in words: the ladder as a table, and the verdict as a sentence."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..base.sentences import with_standard_error
from ..base.shown import html_table
from ..base.units import unit_after_number, unit_of
from ..blocks import Value
from ..check.log_reading import short_segment_lines
from ..measurement.bandwidth import slower_sensors
from .adequacy import records_differ
from .criteria import CRITERIA
from .fit import Fit
from .left_out import left_out_lines, percent, possible_next
from .noise_floor import say_floors
from .open_parameters import open_parameters_line
from .record_offsets import offset_groups
from .record_shift import shifts_of

if TYPE_CHECKING:
    from .arms.diagnosis import ArmRung
    from .diagnosis import Diagnosis
    from .rung import Rung


def ladder_html(rungs: Iterable[Rung | ArmRung], *, floor: float, note: str) -> str:
    """The ladder as an HTML table for a notebook.

    floor: relative noise floor;  note: text below the table
    """
    rows = [
        (
            "(your model, re-estimated)" if r.added is None else f"+ {r.title}",
            f"{100 * r.fit.fit_error:.2f} %",
            f"{100 * r.fit.check_error:.2f} %",
        )
        for r in rungs
    ]
    rows.append(("noise floor", "", f"{100 * floor:.2f} %"))
    return html_table("Diagnosis", ("added", "fit error", "check error"), rows, note=note)


def offset_rows(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Offsets of single records, estimated with the final model of the diagnosis."""
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


def _estimate_text(value: Value, unit: str) -> str:
    """A value with its standard error; without one, it is called not determined."""
    text = f"{with_standard_error(value.value, value.stderr)}{unit_after_number(unit)}"
    if value.fixed or math.isfinite(value.stderr):
        return text
    return f"{text}, not determined by these records"


#: relative difference from which the error at the command is stated in addition
DIFFERENT = 0.02


def command_error_text(fit: Fit) -> str | None:
    """The error at the command and the blind share; None where both add nothing."""
    command_error = fit.at_command
    alike = abs(command_error.error - fit.check_error) <= DIFFERENT * fit.check_error
    if alike and command_error.blind == 0.0:
        return None
    blind = (
        f", undefined in {100 * command_error.blind:.2g} % of the motion"
        if command_error.blind
        else ""
    )
    return f"check error at the command: {percent(command_error.error)}{blind}"


def could_be_text(rung: Rung, *, named: bool = True) -> str | None:
    """Other effects that a rung could be; None where none need be named.

    They are named where the model before the rung left only noise, or the rung's effect is not
    named.
    """
    if rung.could_be is None:
        return None
    others = ", ".join(map(str, rung.could_be))
    if named:
        others = others or "none of the other candidates"
        return f"without this effect the model leaves only noise; other possible effects: {others}"
    also = f"other possible effects: {others}" if others else "no other candidate explains as much"
    return f"unexplained: this effect is less likely than not; {also}"


def describe_addition(diagnosis: Diagnosis, rung: Rung) -> list[str]:
    """Lines on the effect that a rung added: its parameters, and other effects that it could be."""
    assert rung.added is not None
    model, lines = diagnosis.model, []
    for p in rung.added.effect.parameters:
        full = f"{rung.added.at}.{rung.added.effect.name}.{p}"
        value = model.parameters[full]
        bound = "  at its bound" if full in diagnosis.after.at_bound else ""
        lines.append(f"      {p} = {_estimate_text(value, model.unit(full))}{bound}")
    if (text := command_error_text(rung.fit)) is not None:
        lines.append(f"      {text}")
    if rung.alternatives:
        others = ", ".join(map(str, rung.alternatives))
        lines.append(f"      equivalent on these records: {others}")
    named = rung.added in diagnosis.named or bool(rung.alternatives)
    if (could_be := could_be_text(rung, named=named)) is not None:
        lines.append(f"      {could_be}")
    lines += [
        f"      not determined: {one.sentence}"
        for one in diagnosis.undetermined
        if one.candidate == rung.added
    ]
    return lines


def ladder_text(diagnosis: Diagnosis) -> str:
    """The ladder as a table, with parameters, noise floor and verdict."""
    lines = [f"{'added':<42}{'fit error':>10}{'check error':>13}"]
    for rung in diagnosis.rungs:
        name = "(your model, re-estimated)" if rung.added is None else f"+ {rung.title}"
        lines.append(
            f"{name:<42}{100 * rung.fit.fit_error:>9.2f}%{100 * rung.fit.check_error:>12.2f}%"
        )
        if rung.added is None:
            continue
        lines += describe_addition(diagnosis, rung)
    lines += [
        f"offset of {o['record']} alone: {o['of'].replace('_', ' ')} {o['value']:.4g} {o['unit']}"
        for o in offset_rows(diagnosis)
    ]
    lines += [str(shift) for shift in shifts_of(diagnosis.model, diagnosis.prepared.stretches)]
    lines.append(
        f"{'noise floor':<42}{'':>10}{100 * diagnosis.floor.value:>12.2f}%"
        f"  ({diagnosis.floor.source})"
    )
    lines.append(_bandwidth_line(diagnosis))
    if diagnosis.left > CRITERIA.countable:
        lines.append(
            f"{'':<42}the floor contains no noise of the force: state `noise` at the channel"
        )
    if (near := diagnosis.near_reversals) is not None:
        lines.append(f"check error {near}")
    if diagnosis.learnable is not None:
        lines.append(f"black box: {diagnosis.learnable}")
    if diagnosis.repeats is not None:
        lines.append(f"repeats: {diagnosis.repeats}")
    lines += left_out_lines(diagnosis)
    lines += [f"set aside: {one}" for one in diagnosis.set_aside]
    lines += [f"left out: {words}" for words in diagnosis.left_out]
    if records_differ(diagnosis.after):
        lines.append(records_line(diagnosis))
    lines += short_segment_lines(diagnosis.prepared.experiment)
    if diagnosis.verdict == "model_adequate" and (line := open_parameters_line(diagnosis.model)):
        lines.append(line)
    lines.append("")
    lines.append(sentence(diagnosis))
    return "\n".join(lines)


def _bandwidth_line(diagnosis: Diagnosis) -> str:
    """A sentence on the frequencies that the errors of the table include."""
    stated, used = diagnosis.experiment.bandwidth, diagnosis.prepared.bandwidth
    source = "chosen: up to there the positions show motion"
    if stated is not None:
        source = "stated"
        if used < stated:
            name, rate = min(slower_sensors(diagnosis.experiment), key=lambda one: one[1])
            source = f"stated: {stated:.3g} Hz, but {name} has {rate:.4g} readings in a second"
    return f"compared up to {used:.3g} Hz ({source})"


def records_line(diagnosis: Diagnosis) -> str:
    """A sentence that the check error exceeds the fit error, with the likely cause."""
    after, on_all = diagnosis.after, diagnosis.on_all_records
    ratio = after.check_error / after.fit_error
    if not diagnosis.prepared.of("check"):
        return (
            f"blocks: the error on blocks that are left out of the fit in turn is {ratio:.2g} "
            "times that on the fit: the other blocks do not determine the parameters. Record each "
            "motion twice"
        )
    line = f"records: the error on the check records is {ratio:.2g} times that on the fit records"
    if on_all is not None and on_all < 0.5 * after.check_error:
        return (
            f"{line}. A fit to all records leaves {100 * on_all:.3g} % of the check records: the "
            "fit records alone do not determine the parameters. Use a record that moves like the "
            "check records for the fit, too"
        )
    return (
        f"{line}: the machine was not the same in both (friction, temperature, load), or moved "
        "differently"
    )


def floors_apart(left: float, without: float) -> tuple[str, str]:
    """Two errors in noise floors, with as many decimals as show which one is smaller."""
    if left > CRITERIA.countable:
        return say_floors(left), say_floors(without)
    digits = next((d for d in (1, 2, 3) if f"{left:.{d}f}" != f"{without:.{d}f}"), 4)
    return f"{left:.{digits}f}", f"{without:.{digits}f}"


def sentence(diagnosis: Diagnosis) -> str:
    """The verdict of a diagnosis in words."""
    left = say_floors(diagnosis.left)
    more = f" The remaining error is {left} noise floors: more is missing.{_nearest(diagnosis)}"
    if diagnosis.may_be_noise:
        more = (
            f" The remaining error is {left} noise floors of {100 * diagnosis.floor.value:.3g} "
            f"%. With this model sensor errors leave {100 * diagnosis.floor.drawn:.3g} %: these "
            "records do not show whether more is missing."
        )
    rest = more if diagnosis.more_is_missing else ""
    if (moment := diagnosis.moment) is not None:
        whole, without = floors_apart(diagnosis.left, moment.without)
        rest = (
            f" The remaining error is {whole} noise floors, but {without} "
            f"without one moment ({moment})."
        )
    if diagnosis.verdict == "model_adequate":
        noise = f" The remaining error is noise ({diagnosis.left:.2f} noise floors)."
        return f"verdict: model_adequate.{rest or noise}"
    if diagnosis.verdict == "effects_missing":
        added = [r for r in diagnosis.rungs if r.added is not None]
        names = ", ".join(
            " or ".join((r.title, *map(str, r.alternatives)))
            for r in added
            if r.added in diagnosis.missing
        )
        less = [r.title for r in added if r.added not in diagnosis.missing]
        describe = "this effect describes" if len(less) == 1 else "these effects describe"
        others = (
            f" {', '.join(less)}: less likely than not; the force that {describe} counts as "
            "unexplained."
            if less
            else ""
        )
        return f"verdict: effects_missing: {names}.{others}{rest}"
    if diagnosis.unlikely:
        names = ", ".join(r.title for r in diagnosis.rungs if r.added is not None)
        return (
            f"verdict: undecided, leading candidate {names}: less likely than not, because "
            f"{left} noise floors are left."
        )
    if len(diagnosis.rungs) > 1 and any(r.added and not r.alternatives for r in diagnosis.rungs):
        titles = [r.title for r in diagnosis.rungs if r.added is not None]
        helps = "helps, but explains" if len(titles) == 1 else "help, but explain"
        return (
            f"verdict: undecided. {', '.join(titles)} {helps} less than half of what is missing: "
            f"{left} noise floors are left."
        )
    if diagnosis.groups:
        names = "; ".join(" or ".join(map(str, g)) for g in diagnosis.groups)
        return f"verdict: undecided, {names}: these records do not decide.{rest}"
    if silent := diagnosis.why_silent:
        return f"verdict: undecided. {silent}"
    which = "effect that may be named" if left_out_lines(diagnosis) else "candidate effect"
    return (
        f"verdict: undecided. No {which} explains the {left} noise floors that are left."
        f"{_nearest(diagnosis)}"
    )


def _nearest(diagnosis: Diagnosis) -> str:
    """A sentence on the candidate with the least error where none is supported; "": none helps.

    Candidates that are listed beside an accepted one are not named a second time.
    """
    if diagnosis.open is not None:  # read from a file, which has no rankings
        others = [q.others[0] for q in diagnosis.open if q.added is None]
    else:
        others = [(r.candidate, r.fit) for r in possible_next(diagnosis)]
    least = (1.0 - CRITERIA.relevant) * diagnosis.after.check_error**2
    listed = [candidate for group in diagnosis.groups for candidate in group]
    for candidate, fit in [o for o in others if o[0] not in listed][:1]:
        if fit.check_error**2 < least:
            why = next((a.reason for a in diagnosis.set_aside if a.candidate == candidate), "")
            return (
                f" {candidate} comes nearest and would leave {100 * fit.check_error:.3g} %: "
                f"{why or 'on these records this may be chance'}."
            )
    return ""
