"""Candidates that a model may lack, best first, as a table."""

from __future__ import annotations

from ...base.sentences import wrap
from ...base.shown import html_table
from ...diagnose.ranking import Ranking
from ..registry import shows

_HEAD = ("candidate", "fit error", "check error", "score", "behind")
_LEGEND = (
    "standard deviations: score, by which the check error falls; behind, by which the error is "
    "larger than that of the best"
)


def _rows(ranking: Ranking) -> list[tuple[str, ...]]:
    """The model alone, then each candidate that gains something, with a remark as the last cell."""
    base = _errors(ranking.base.fit_error, ranking.base.check_error)
    rows: list[tuple[str, ...]] = [("(the model)", *base, "", "", "")]
    for r in ranking.ranked:
        if not r.is_idle:
            errors = _errors(r.fit.fit_error, r.fit.check_error)
            rows.append((r.title, *errors, f"{r.score:.1f}", f"{r.behind:.1f}", r.note))
    return rows


def _errors(fit: float, check: float) -> tuple[str, str]:
    return f"{100 * fit:.2f}%", f"{100 * check:.2f}%"


def _gain_nothing(ranking: Ranking) -> str:
    idle = [r.title for r in ranking.ranked if r.is_idle]
    return f"gain nothing: {', '.join(idle)}" if idle else ""


@shows("table")
def ranking_table(ranking: Ranking) -> str:
    """The table of a notebook; candidates that gain nothing stand below."""
    note = "; ".join(filter(None, (_gain_nothing(ranking), _LEGEND)))
    return html_table("Candidates, best first", (*_HEAD, ""), _rows(ranking), note=note)


@shows("text")
def ranking_text(ranking: Ranking) -> str:
    """A line for each candidate; those that gain nothing share the last one."""
    rows = [(*_HEAD, ""), *_rows(ranking)]
    title, *numbers = [max(map(len, c)) for c in list(zip(*rows, strict=True))[:-1]]
    lines = []
    for name, *cells, note in rows:
        aligned = (f"{c:>{w}}" for c, w in zip(cells, numbers, strict=True))
        lines.append("  ".join((f"{name:<{title}}", *aligned, note)).rstrip())
    below = filter(None, (_gain_nothing(ranking), _LEGEND))
    return "\n".join((*lines, *(wrap(b, rest="  ") for b in below)))
