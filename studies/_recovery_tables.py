"""Rows of a campaign, one a case and method, and the tables that are counted from them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from _campaign import Planned
from _scoring import (
    CORRECT,
    SINGLE,
    Answer,
    Calibration,
    Estimate,
    Key,
    Share,
    Truth,
    calibration,
    estimates,
    judge,
    load_answer,
    load_truth,
    quantile_text,
    share,
)
from _terms import WITH_MEMORY

#: where each method's answers lie, and how it is called in tables
METHODS = {"answers": "teleopdesign", "pysindy": "PySINDy", "sysidentpy": "SysIdentPy"}
#: bands of the noise floor, relative to the measured force
NOISE = (0.0, 0.01, 0.02, np.inf)


@dataclass(frozen=True)
class Row:
    """What one method said about one case; errors are relative force errors on the check record.

    seconds: of the processor, for the answer
    """

    case: str
    method: str
    level: str
    kind: str
    axis: str
    excitation: str
    rate: float
    true: str
    verdict: str
    named: str
    groups: str
    outcome: str
    probability: float
    error_before: float
    error_after: float
    error_true: float
    noise_floor: float
    seconds: float

    @property
    def noise(self) -> str:
        """Band of the noise floor."""
        place = int(np.searchsorted(NOISE, self.noise_floor, side="right"))
        low, high = 100 * NOISE[place - 1], 100 * NOISE[place]
        return f"below {high:g} %" if place == 1 else f"{low:g} % and more" if high == np.inf else (
            f"{low:g} to {high:g} %"
        )  # fmt: skip


@dataclass(frozen=True)
class Campaign:
    """Everything that the tables and figures are made from.

    best: (probability, true?) of the most probable candidate, a pair a case;  every: of all
    candidates, a list a case
    """

    rows: tuple[Row, ...]
    estimates: tuple[Estimate, ...]
    best: tuple[tuple[float, bool], ...]
    every: tuple[tuple[tuple[float, bool], ...], ...]
    without_machine: int

    def of(self, method: str, *levels: str) -> list[Row]:
        """Rows of a method at some levels (all where none is given)."""
        return [r for r in self.rows if r.method == method and (not levels or r.level in levels)]

    @property
    def methods(self) -> list[str]:
        """Methods that answered anything."""
        return [m for m in METHODS if any(r.outcome != "no answer" for r in self.of(m))]


def text(keys: Iterable[Key], between: str = " + ") -> str:
    """Effects with their places, as "stribeck@device + bias@device"."""
    return between.join(f"{effect}@{at}" for effect, at in keys)


def row_of(planned: Planned, truth: Truth, answer: Answer | None, method: str) -> Row:
    """The row of one case; what an answer lacks is empty or NaN."""
    nan = float("nan")
    ladder = answer.content.get("ladder", []) if answer else []
    return Row(
        case=truth.name,
        method=method,
        level=truth.level,
        kind=planned.kind,
        axis=truth.content["axis"],
        excitation=planned.excitation,
        rate=planned.rate,
        true=text(truth.effects),
        verdict=answer.verdict if answer else "",
        named=text(answer.named) if answer else "",
        groups="; ".join(text(sorted(g), " or ") for g in answer.groups) if answer else "",
        outcome=judge(truth, answer),
        probability=max(answer.probability.values(), default=nan) if answer else nan,
        error_before=ladder[0]["check_error"] if ladder else nan,
        error_after=ladder[-1]["check_error"] if ladder else nan,
        error_true=truth.content["check_error_true"],
        noise_floor=truth.content["noise_floor"],
        seconds=float(answer.content.get("processor_seconds", nan)) if answer else nan,
    )


def collect(folder: Path, cases: Sequence[Planned], methods: Sequence[str]) -> Campaign:
    """Judge every answer of a campaign's folder; cases that were not made are left out."""
    rows, parameters, best, every = [], [], [], []
    missing = 0
    for planned in cases:
        if not (folder / "truth" / f"{planned.name}.json").exists():
            missing += 1
            continue
        truth = load_truth(folder, planned.name)
        for method in methods:
            answer = load_answer(folder / method / f"{planned.name}.json")
            failed = [folder / "failed" / f"{planned.name}.{what}.txt" for what in (method, "all")]
            if answer is None and not any(path.exists() for path in failed):
                continue  # not done yet
            rows.append(row_of(planned, truth, answer, method))
            if method == "answers" and answer is not None:
                parameters += estimates(truth, answer)
                pairs = [(p, k in truth.effects) for k, p in answer.probability.items()]
                every.append(tuple(pairs))
                if pairs:
                    best.append(max(pairs, key=lambda pair: pair[0]))
    return Campaign(tuple(rows), tuple(parameters), tuple(best), tuple(every), missing)


def share_correct(rows: Iterable[Row]) -> Share:
    """Share of cases whose first name is right, or that list the look-alikes."""
    return share(r.outcome in CORRECT for r in rows)


def _is(*outcomes: str) -> Callable[[list[Row]], Share]:
    return lambda rows: share(r.outcome in outcomes for r in rows)


def _by_terms(rows: list[Row]) -> Share:
    """Found, of the effects that are a function of the motion and the command."""
    return share_correct(r for r in rows if r.true.partition("@")[0] not in WITH_MEMORY)


def _names(rows: list[Row]) -> Share:
    return share(bool(r.named) for r in rows)


#: question of the main table -> levels of its cases, what is counted
QUESTIONS: dict[str, tuple[tuple[str, ...], Callable[[list[Row]], Share]]] = {
    "one clear effect: named first, or its look-alikes listed": (("clear",), share_correct),
    "one clear effect: named, and nothing else": (("clear",), _is("right", "look-alike")),
    "one clear effect without a state of its own: first, or look-alikes": (("clear",), _by_terms),
    "one weak effect: named first, or its look-alikes listed": (("weak",), share_correct),
    "one weak effect: named, and nothing else": (("weak",), _is("right", "look-alike")),
    "two effects: exactly the two": (("double",), _is("right")),
    "nothing missing: false alarm": (("null",), _is("false alarm")),
    "nothing missing: an effect named": (("null",), _names),
    "an effect that no catalogue has: a listed one named with confidence": (
        ("outside",),
        _is("confident"),
    ),
}  # fmt: skip


def line(cells: Iterable[object]) -> str:
    """One line of a markdown table."""
    return "| " + " | ".join(map(str, cells)) + " |"


def main_table(campaign: Campaign) -> str:
    """The table for the README, a column a method."""
    methods = campaign.methods
    lines = [line(["", *(METHODS[m] for m in methods)]), line(["---"] * (1 + len(methods)))]
    for question, (levels, count) in QUESTIONS.items():
        cells = [count(campaign.of(m, *levels)) for m in methods]
        lines.append(line([question, *cells]))
    empty = [""] * (len(methods) - 1)
    right = [r for r in campaign.of("answers", *SINGLE, "double")]
    right = [r for r in right if r.outcome in ("right", "look-alike")]
    ratios = [r.error_after / r.error_true for r in right]
    over = "check error after, over that of the true model"
    lines.append(line([f"{over}: median", quantile_text(ratios, 0.5), *empty]))
    lines.append(line([f"{over}: 95th percentile", quantile_text(ratios, 0.95), *empty]))
    inside = share(e.inside for e in campaign.estimates)
    lines.append(line(["true parameter inside its 95 % interval", inside, *empty]))
    for name, one in calibrations(campaign).items():
        low, high = one.interval
        shown = f"{one.error:.3f} ({low:.3f} to {high:.3f}), n = {one.n}"
        lines.append(line([f"calibration error of `probability`, {name}", shown, *empty]))
    return "\n".join(lines)


def calibrations(campaign: Campaign) -> dict[str, Calibration]:
    """Calibration of the most probable candidate of each case, and of all candidates."""
    return {
        "best candidate": calibration([[p] for p in campaign.best], np.random.default_rng(0)),
        "all candidates": calibration(campaign.every, np.random.default_rng(0)),
    }


def strata_table(campaign: Campaign) -> str:
    """Found single effects by machine, excitation, noise and sample rate."""
    methods = campaign.methods
    lines = [line(["one effect, found", *(METHODS[m] for m in methods)])]
    lines.append(line(["---"] * (1 + len(methods))))
    for name in ("level", "kind", "axis", "excitation", "noise", "rate"):
        values = sorted({getattr(r, name) for r in campaign.of("answers", *SINGLE)})
        for value in values:
            cells = [
                share_correct(r for r in campaign.of(m, *SINGLE) if getattr(r, name) == value)
                for m in methods
            ]
            shown = f"{value:g} Hz" if isinstance(value, float) else value
            lines.append(line([f"{name}: {shown}", *cells]))
    return "\n".join(lines)


def effects_table(campaign: Campaign, cannot: dict[str, frozenset[str]]) -> str:
    """Found single effects and parameters inside their interval, by effect.

    cannot: method -> effects that it has no means to express
    """
    methods = campaign.methods
    head = ["effect", *(METHODS[m] for m in methods), "parameters inside 95 %"]
    lines = [line(head), line(["---"] * len(head))]
    for effect in sorted({r.true.partition("@")[0] for r in campaign.of("answers", *SINGLE)}):
        cells = []
        for m in methods:
            rows = [r for r in campaign.of(m, *SINGLE) if r.true.partition("@")[0] == effect]
            cells.append(
                "cannot express it" if effect in cannot.get(m, ()) else str(share_correct(rows))
            )
        inside = share(e.inside for e in campaign.estimates if e.effect == effect)
        lines.append(line([f"`{effect}`", *cells, inside]))
    return "\n".join(lines)


def outcomes_table(campaign: Campaign) -> str:
    """How many cases of each level had which outcome, for each method."""
    head = ["level", "method", "outcomes"]
    lines = [line(head), line(["---"] * len(head))]
    for level in ("clear", "weak", "double", "null", "outside"):
        for m in campaign.methods:
            outcomes = [r.outcome for r in campaign.of(m, level)]
            counts = sorted({(-outcomes.count(o), o) for o in outcomes})
            shown = ", ".join(f"{o} {-n}" for n, o in counts)
            if shown:
                lines.append(line([level, METHODS[m], shown]))
    return "\n".join(lines)


def write_rows(campaign: Campaign, path: Path) -> None:
    """Rows as PATH.csv and PATH.nc, parameters as PATH_parameters.csv."""
    table = pd.DataFrame([asdict(r) for r in campaign.rows])
    table.to_csv(path.with_suffix(".csv"), index=False)
    data = table.to_xarray().rename(index="row")
    data.attrs["title"] = "hidden effects: what each method said about each case"
    data["seconds"].attrs["units"] = "s"
    data["rate"].attrs["units"] = "Hz"
    data.to_netcdf(path.with_suffix(".nc"))
    parameters = pd.DataFrame([asdict(e) | {"inside": e.inside} for e in campaign.estimates])
    parameters.to_csv(path.with_name(f"{path.name}_parameters.csv"), index=False)
