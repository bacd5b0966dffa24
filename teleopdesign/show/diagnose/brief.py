"""The first screen of a diagnosis: the verdict, the errors behind it, and what was set aside.

Some twelve lines with the next commands: where the ladder is long, the values of its effects give
way, then the rows between the first and the last. The whole ladder with its reasons is the
registry's "text".
"""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from typing import TYPE_CHECKING

from ...base.sentences import WIDTH, with_standard_error, wrap
from ...base.units import unit_after_number
from .text import NAME, error_line, floor_line, name_of_error, table_of_joints
from .verdict import sentence

if TYPE_CHECKING:
    from ...diagnose.diagnosis import Diagnosis

#: lines of a screen that has room for the values of the effects
LINES = 9
#: rows of a ladder that are shown; of a longer one the first and the last
ROWS = 3


def brief_text(diagnosis: Diagnosis) -> str:
    """The verdict first, then before, after and the noise floor, and how much more there is to say.

    Values of the effects that were added stand beside their rows. Reasons, candidates that were not
    accepted and the whole model are counted in one line, and stand in the long text.
    """
    first = wrap(sentence(diagnosis)).split("\n")
    lines = [*first, *table_of_joints(diagnosis)]
    if not diagnosis.joints:
        lines = [*first, *_body(diagnosis, with_values=True)]
        if len(lines) > LINES:
            lines = [*first, *_body(diagnosis, with_values=False)]
    if diagnosis.no_named_law is not None:
        lines.append(wrap(str(diagnosis.no_named_law)))
    if diagnosis.kind:  # the list of what needs a time is long
        lines += [textwrap.shorten(f"left out: {diagnosis.left_out[-1]}", WIDTH)]
    elif diagnosis.left_out:
        lines.append(wrap(f"left out: {'; '.join(diagnosis.left_out)}"))
    more = _more(diagnosis) or "how the log was read, and the whole model"
    return "\n".join([*lines, f"not shown: {more} (--verbose, or --report F.html)"])


def _body(diagnosis: Diagnosis, *, with_values: bool) -> Iterator[str]:
    """Lines of one body, or of two: ladder, floor."""
    yield f"{'':<{NAME}}{'fit error':>10}{name_of_error(diagnosis):>15}"
    rungs, between = diagnosis.rungs, len(diagnosis.rungs) - ROWS
    for row in rungs if with_values or between <= 0 else (rungs[0], rungs[-1]):
        name = "your model, re-estimated" if row.added is None else f"+ {row.title}"
        if row.added is not None and not with_values and between > 0:
            name = f"with all {len(rungs) - 1} effects of the ladder"
        yield error_line(name, row)
        if row.added is not None and with_values:
            begin = f"{row.added.at}.{row.added.effect.name}."
            yield f"    {', '.join(_values(diagnosis, begin))}"
    yield floor_line(diagnosis)


def _values(diagnosis: Diagnosis, begin: str) -> Iterator[str]:
    """Estimates of one effect, each "name = value +- standard error unit"."""
    model = diagnosis.model
    for name, value in model.parameters.items():
        if name.startswith(begin):
            number = with_standard_error(value.value, value.stderr)
            bound = " (at its bound)" if name in diagnosis.at_bound else ""
            unit = unit_after_number(model.unit(name))
            yield f"{name.removeprefix(begin)} = {number}{unit}{bound}"


def _more(diagnosis: Diagnosis) -> str:
    """What the long text says in addition, counted; "": no more than it always does."""
    parts = list(diagnosis.joints.values()) or [diagnosis]
    counts = {
        "effects not accepted": sum(len(one.not_accepted) for one in parts),
        "set aside": sum(len(one.set_aside) for one in parts),
        "parameters not determined": sum(len(one.undetermined) for one in parts),
        "remarks": len(diagnosis.remarks),
    }
    return ", ".join(f"{n} {name}" for name, n in counts.items() if n)
