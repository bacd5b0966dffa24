"""A diagnosis in words: the ladder as a table, and the verdict as a sentence."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...base.sentences import percent, with_standard_error
from ...base.shown import html_table
from ...base.units import unit_after_number
from ...blocks import Value
from ...diagnose.criteria import CRITERIA
from ...diagnose.evidence import records_differ
from ...diagnose.undetermined import open_parameters_line
from ..registry import shows
from .verdict import sentence

if TYPE_CHECKING:
    from ...diagnose.diagnosis import Diagnosis
    from ...diagnose.statements import LadderRow

#: columns of the name of a row
NAME = 42
#: relative difference from which the error at the command is stated in addition
DIFFERENT = 0.02


@shows("table")
def ladder_html(diagnosis: Diagnosis) -> str:
    """The ladder as an HTML table for a notebook, with the verdict."""
    rows = [
        (
            "(your model, re-estimated)" if r.added is None else f"+ {r.title}",
            f"{100 * r.fit_error:.2f} %",
            f"{100 * r.check_error:.2f} %",
        )
        for r in diagnosis.rungs
    ]
    rows.append(("noise floor", "", f"{100 * diagnosis.floor.value:.2f} %"))
    sentences = (f"{joint}: {sentence(one)}" for joint, one in diagnosis.joints.items())
    note = "; ".join(sentences) or sentence(diagnosis)
    return html_table(
        "Diagnosis", ("added", "fit error", name_of_error(diagnosis)), rows, note=note
    )


def name_of_error(diagnosis: Diagnosis) -> str:
    """The name of the error on rows that were not fitted: of records, or of blocks in turn."""
    return "check error" if diagnosis.check == "records" else "held-out error"


@shows("text")
def ladder_text(diagnosis: Diagnosis) -> str:
    """The ladder as a table, with parameters, noise floor and verdict."""
    lines = [f"{'added':<{NAME}}{'fit error':>10}{name_of_error(diagnosis):>15}"]
    for row in diagnosis.rungs:
        name = "(your model, re-estimated)" if row.added is None else f"+ {row.title}"
        lines.append(error_line(name, row))
        if row.added is not None:
            lines += _describe_addition(diagnosis, row)
    if diagnosis.joints:
        return "\n".join([*lines, *_lines_of_joints(diagnosis)])
    lines += [str(offset) for offset in diagnosis.offsets]
    lines += [str(shift) for shift in diagnosis.record_shift.values()]
    lines.append(f"{floor_line(diagnosis)}  ({diagnosis.floor.source})")
    source = f" ({diagnosis.bandwidth_source})" if diagnosis.bandwidth_source else ""
    band = "" if diagnosis.kind else f" up to {diagnosis.bandwidth:.3g} Hz"
    lines.append(f"compared{band}{source}")
    if diagnosis.left > CRITERIA.countable:
        lines.append(
            f"{'':<42}the floor contains no noise of the force: state `noise` at the channel"
        )
    lines += [*_lines_of_rest(diagnosis), *_lines_not_accepted(diagnosis)]
    lines += [f"set aside: {one}" for one in diagnosis.set_aside]
    lines += [str(diagnosis.no_named_law)] * (diagnosis.no_named_law is not None)
    lines += [f"left out: {words}" for words in diagnosis.left_out]
    if records_differ(diagnosis.after):
        lines.append(records_line(diagnosis))
    lines += diagnosis.remarks
    if diagnosis.verdict == "model_adequate" and (line := open_parameters_line(diagnosis.model)):
        lines.append(line)
    return "\n".join([*lines, "", sentence(diagnosis)])


def error_line(name: str, row: LadderRow) -> str:
    """A row of the ladder: name and both errors."""
    return f"{name:<{NAME}}{100 * row.fit_error:>9.2f}%{100 * row.check_error:>14.2f}%"


def floor_line(diagnosis: Diagnosis) -> str:
    """The noise floor, below the errors of the ladder."""
    return f"{'noise floor':<{NAME}}{'':>10}{100 * diagnosis.floor.value:>14.2f}%"


def table_of_joints(diagnosis: Diagnosis) -> Iterator[str]:
    """Lines with the errors and the verdict of each joint of an arm."""
    yield f"{'joint':<20}{'before':>10}{'after':>10}{'floor':>10}  verdict"
    for joint, one in diagnosis.joints.items():
        ends = [row.joints[joint].check_error for row in (diagnosis.before, diagnosis.after)]
        errors = "".join(f"{100 * e:>9.2f}%" for e in (*ends, one.floor.value))
        yield f"{joint:<20}{errors}  {one.verdict}"


def _lines_of_joints(diagnosis: Diagnosis) -> list[str]:
    """What follows the ladder of an arm: errors of each joint, and what is said of it."""
    lines = [floor_line(diagnosis), "", *table_of_joints(diagnosis)]
    for joint, one in diagnosis.joints.items():
        more = _lines_not_accepted(one) if one.more_is_missing else []
        rest = [*map(str, one.record_shift.values()), *_lines_of_rest(one), *more]
        rest += [f"set aside: {aside}" for aside in one.set_aside]
        lines += ["", f"{joint}: {sentence(one)}", *(f"  {line}" for line in rest)]
    if diagnosis.left_out:
        lines += ["", *(f"left out: {words}" for words in diagnosis.left_out)]
    return [*lines, "", sentence(diagnosis)]


def _lines_of_rest(diagnosis: Diagnosis) -> list[str]:
    """What the final model leaves: near reversals, what trees learn of it, what repeats."""
    lines = []
    if (near := diagnosis.near_reversals) is not None:
        lines.append(f"{name_of_error(diagnosis)} {near}")
    if diagnosis.learnable is not None:
        lines.append(f"black box: {diagnosis.learnable}")
    if diagnosis.repeats is not None:
        lines.append(f"repeats: {diagnosis.repeats}")
    return lines


def _lines_not_accepted(diagnosis: Diagnosis) -> list[str]:
    """The candidates that leave clearly less than the final model, each with the reason."""
    return [
        f"refused: {one.candidate} ({percent(one.check_error)}; at the command "
        f"{percent(one.check_error_at_command)}): {one.reason}"
        if one.why == "refused"
        else f"not determined: {one.candidate} leaves least ({percent(one.check_error)}), but "
        f"{one.reason}"
        for one in diagnosis.not_accepted
    ]


def _describe_addition(diagnosis: Diagnosis, row: LadderRow) -> list[str]:
    """Lines on the effect that a row added: its parameters, and other effects that it could be."""
    added = row.added
    assert added is not None
    if diagnosis.joints:  # its joint says more of it
        diagnosis = diagnosis.joints[added.at]
        row = next(r for r in diagnosis.rungs if r.added == added)
    model, lines = diagnosis.model, []
    for p in added.effect.parameters:
        full = f"{added.at}.{added.effect.name}.{p}"
        bound = "  at its bound" if full in diagnosis.at_bound else ""
        text = _estimate_text(model.parameters[full], model.unit(full))
        lines.append(f"      {p} = {text}{bound}")
    if (at_command := command_error_text(row)) is not None:
        lines.append(f"      {at_command}")
    if row.alternatives:
        others = ", ".join(str(one.candidate) for one in row.alternatives)
        lines.append(f"      equivalent on these records: {others}")
    if (could_be := could_be_text(row, named=row.named or bool(row.alternatives))) is not None:
        lines.append(f"      {could_be}")
    lines += [
        f"      not determined: {one.sentence}"
        for one in diagnosis.undetermined
        if one.candidate == added
    ]
    return lines


def _estimate_text(value: Value, unit: str) -> str:
    """A value with its standard error; without one, it is called not determined."""
    text = f"{with_standard_error(value.value, value.stderr)}{unit_after_number(unit)}"
    if value.fixed or math.isfinite(value.stderr):
        return text
    return f"{text}, not determined by these records"


def command_error_text(row: LadderRow) -> str | None:
    """The error at the command and the blind share; None where both add nothing."""
    error, blind = row.check_error_at_command, row.blind
    if abs(error - row.check_error) <= DIFFERENT * row.check_error and blind == 0.0:
        return None
    undefined = f", undefined in {percent(blind, '.2g')} of the motion" if blind else ""
    return f"check error at the command: {percent(error)}{undefined}"


def could_be_text(row: LadderRow, *, named: bool = True) -> str | None:
    """Other effects that a row's could be; None where none need be named.

    They are named where the model before left only noise, or the row's effect is not named.
    """
    if row.could_be is None:
        return None
    others = ", ".join(map(str, row.could_be))
    if named:
        others = others or "none of the other candidates"
        return f"without this effect the model leaves only noise; other possible effects: {others}"
    also = f"other possible effects: {others}" if others else "no other candidate explains as much"
    return f"unexplained: this effect is less likely than not; {also}"


def records_line(diagnosis: Diagnosis) -> str:
    """A sentence that the check error exceeds the fit error, with the likely cause."""
    after, on_all = diagnosis.after, diagnosis.on_all_records
    ratio = after.check_error / after.fit_error
    if diagnosis.held_out:
        return (
            f"blocks: the error on blocks that are left out of the fit in turn is {ratio:.2g} "
            "times that on the fit: the other blocks do not determine the parameters. Record each "
            "motion twice"
        )
    line = f"records: the error on the check records is {ratio:.2g} times that on the fit records"
    if on_all is not None and on_all < 0.5 * after.check_error:
        return (
            f"{line}. A fit to all records leaves {percent(on_all, '.3g')} of the check records: "
            "the fit records alone do not determine the parameters. Use a record that moves like "
            "the check records for the fit, too"
        )
    return (
        f"{line}: the machine was not the same in both (friction, temperature, load), or moved "
        "differently"
    )
