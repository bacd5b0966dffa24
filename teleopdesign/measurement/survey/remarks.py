"""Constants in the lines above a table: "8192 counts per turn", "kt = 0.1 Nm/A"."""

from __future__ import annotations

import itertools
import re
from collections.abc import Sequence

from ...base.units import is_unit, measures, si_factor
from ..column_names import unit_of_text
from ..doors._cells import number_of

_TURN = r"(?:turn|rev|revolution|umdrehung|tour|u\b)"
_COUNTS = r"(?:counts?|cnts?|ticks?|increments?|inkremente|ink|inc|pulses|impulse|cpr)"
#: texts that state counts per turn: a number before or after the words
_COUNTS_PER_TURN = (
    re.compile(rf"(\d{{2,9}})\s*{_COUNTS}\s*(?:/|per|pro|par)\s*{_TURN}", re.I),
    re.compile(rf"{_COUNTS}[ _]*(?:/|per|pro|par)[ _]*{_TURN}\w*\s*[=:]?\s*(\d{{2,9}})", re.I),
    re.compile(r"\bcpr\s*[=:]?\s*(\d{2,9})|\b(\d{2,9})\s*cpr\b", re.I),
)
_TORQUE_CONSTANT = re.compile(
    r"(?:\bk_?[tm]\b|torque[ _]constant|drehmomentkonstante|constante de couple)\D{0,12}?"
    r"(\d{1,9}(?:[.,]\d{1,9})?(?:e[-+]?\d{1,3})?)\s*([A-Za-z][A-Za-z*·⋅. -]{0,10})/\s*(m?A)\b",
    re.I,
)
#: "gear 50:1", "gear ratio = 50", "Getriebe i = 100"
_GEAR_RATIO = re.compile(
    r"(?:\bgear(?:box)?(?:[ _]?ratio)?\b|\bgetriebe\w*|\breduction\b|\buntersetzung\b)\D{0,12}?"
    r"(\d{1,5}(?:[.,]\d{1,6})?)(?:\s*:\s*1\b)?(?!\s*[:\d]|-)",
    re.I,
)
_RATE_NUMBER = r"([\d.,]{1,20}(?:e[-+]?\d{1,3})?)"
#: "Sample rate: 1000 Hz", "Delta_X 0,001", "Sample Interval,0.001", "tInc = 1e-3"
_SAMPLE_RATE = re.compile(
    r"(?:sampl(?:e|ing)[ _]?(?:rate|frequency)|abtastrate|(?<![a-z])f_?s(?![a-z]))[^\w+-]{1,12}"
    rf"{_RATE_NUMBER}\s*([kM]?Hz|)(?![A-Za-z:/\d-])",
    re.I,
)
_SAMPLE_TIME = re.compile(
    r"(?:sampl(?:e|ing)[ _]?(?:interval|time|period)|delta[ _]?[xt]|t_?inc|abtastzeit"
    r"|(?<![a-z])(?:t_?s|dt)(?![a-z])|^[Th](?= = [\d.e-]+$))"
    rf"(?:\s*[(\[]([mun]?s)[)\]])?[^\w+-]{{1,12}}{_RATE_NUMBER}\s*([mun]?s|)(?![A-Za-z:/\d-])",
    re.I,
)
#: units that are recognised whatever their case, where no other unit is meant by these letters
_UNITS = {"hz": "Hz", "khz": "kHz", "mhz": "MHz"}


def sample_rate_in(remarks: Sequence[str]) -> tuple[float, str] | None:
    """The rate of the rows in Hz, and the line that states it or the time from row to row, in s.

    A scope writes the time from row to row beside its table: "X, CH1, Start, Increment".
    """
    for line in remarks:
        rate, step = (pattern.search(line[:500]) for pattern in (_SAMPLE_RATE, _SAMPLE_TIME))
        if rate is not None and (value := _size(rate[1], rate[2] or "Hz", "frequency")):
            return value, line[:100]
        if step is not None and (value := _size(step[2], step[1] or step[3] or "s", "time")):
            return float(f"{1 / value:.9g}"), line[:100]
    for titles, values in itertools.pairwise(remarks):
        cells = [re.split(r"[,;\t]", text[:500]) for text in (titles, values)]
        for title, cell in zip(*cells, strict=False):
            if title.strip().casefold() == "increment" and (value := _size(cell.strip())):
                return float(f"{1 / value:.9g}"), f"{titles[:50]} / {values[:50]}"
    return None


def _size(text: str, unit: str = "s", quantity: str = "time") -> float:
    """A number with a decimal point or comma, in SI; 0: it is none.

    unit: as a program writes it, also "HZ" or "khz"
    """
    number = number_of(text.rstrip(".,"), comma="," in text)
    known = unit_of_text(unit) or unit_of_text(unit.lower()) or _UNITS.get(unit.lower(), unit)
    if not isinstance(number, float) or not measures(known, quantity):
        return 0.0
    return number * si_factor(known, quantity=quantity)


def counts_per_turn_in(remarks: Sequence[str]) -> tuple[float, str] | None:
    """Counts of an encoder per turn, and the line that states them."""
    for line in remarks:
        for pattern in _COUNTS_PER_TURN:
            if (match := pattern.search(line[:500])) is not None:
                return float(next(filter(None, match.groups()))), line[:100]
    return None


def torque_constant_in(remarks: Sequence[str]) -> tuple[float, str, str] | None:
    """A motor constant, its unit, and the line that states it."""
    for line in remarks:
        if (match := _TORQUE_CONSTANT.search(line[:500])) is None:
            continue
        unit = f"{unit_of_text(match[2]) or match[2].strip()}/{match[3]}"
        if is_unit(unit):
            return float(match[1].replace(",", ".")), unit, line[:100]
    return None


def gear_ratio_in(remarks: Sequence[str]) -> tuple[float, str] | None:
    """Turns of the motor per turn of the joint, and the line that states the ratio."""
    for line in remarks:
        if (match := _GEAR_RATIO.search(line[:500])) is not None:
            return float(match[1].replace(",", ".")), line[:100].lstrip("#%; ")
    return None


#: what a log may state of its clock and of the machine: its lines -> values, then the line
STATEMENTS = (sample_rate_in, counts_per_turn_in, torque_constant_in, gear_ratio_in)
