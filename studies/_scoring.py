"""Judge answers against the truth of cases, and count, each share with its interval.

The rules, a case at a time. Effects are compared with their places; "look-alikes" of a true effect
are those that no method could tell from it on this record, as the truth says.

one effect     right          it alone is named
               right first    it, or a look-alike listed with it, is named first, others after it
               look-alike     the answer lists it as indistinguishable, and only look-alikes with it
               wide group     the answer lists it as indistinguishable from what could be told
               other place    the first named is the true effect at another body
               wrong, undecided, missed (the model was said to be adequate), no answer
two effects    right          exactly the two are named, or listed with their look-alikes alone
               right first    both and others;  half: one of them, nothing wrong;  wrong, ...
none           right          the model is said to be adequate
               false alarm    anything else; `named` says whether an effect was named
outside        right          undecided, or an effect that is not in the catalogue
               unsure         a catalogue effect with a probability below one half
               confident      a catalogue effect with a higher one;  missed
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binomtest, norm, quantile_test

from teleopdesign import EFFECTS

Key = tuple[str, str]
SINGLE = ("clear", "weak")
CORRECT = ("right", "right first", "look-alike")
#: a name said with at least this probability is one that a user would act on
CONFIDENT = 0.5
#: without a measured interaction force nothing tells more inertia from more force per command
SCALE_OF_FORCE = ("added_inertia", "actuator_gain")


def key(entry: dict[str, Any]) -> Key:
    """(effect, place) of an entry of a truth or an answer."""
    return str(entry["effect"]), str(entry["at"])


@dataclass(frozen=True)
class Truth:
    """What a case hides; groups: effects that no method could tell apart on its records."""

    name: str
    level: str
    effects: tuple[Key, ...]
    groups: tuple[frozenset[Key], ...]
    content: dict[str, Any]

    def alike(self, one: Key, other: Key) -> bool:
        """Whether two effects are the same or cannot be told apart."""
        return one == other or any(one in g and other in g for g in self.groups)


def load_truth(folder: Path, name: str) -> Truth:
    """Truth of a case, with the look-alikes that its channels imply."""
    content = json.loads((folder / "truth" / f"{name}.json").read_text(encoding="utf-8"))
    effects = tuple(key(e) for e in content["effects"])
    groups = [frozenset(key(e) for e in g) for g in content["indistinguishable"]]
    description = folder / "cases" / name / "experiment.toml"
    channels = tomllib.loads(description.read_text(encoding="utf-8"))["channels"]
    for effect, at in effects:
        force = "interaction_force" if at == "device" else f"{at}.interaction_force"
        if effect in SCALE_OF_FORCE and force not in channels:
            groups.append(frozenset((e, at) for e in SCALE_OF_FORCE))
    return Truth(name, content["level"], effects, tuple(groups), content)


@dataclass(frozen=True)
class Answer:
    """What a method says; groups: those that it lists as indistinguishable."""

    verdict: str
    named: tuple[Key, ...]
    groups: tuple[frozenset[Key], ...]
    probability: dict[Key, float]
    content: dict[str, Any]

    def together(self, one: Key, other: Key) -> bool:
        """Whether the answer lists two effects as indistinguishable."""
        return any(one in g and other in g for g in self.groups)


def load_answer(path: Path) -> Answer | None:
    """An answer file as `teleopdesign diagnose` writes it; None where there is none."""
    if not path.exists():
        return None
    content = json.loads(path.read_text(encoding="utf-8"))
    return Answer(
        verdict=content["verdict"],
        named=tuple(key(e) for e in content["missing"]),
        groups=tuple(frozenset(key(e) for e in g) for g in content["indistinguishable"]),
        probability={key(c): float(c["probability"]) for c in content["candidates"]},
        content=content,
    )


def judge(truth: Truth, answer: Answer | None) -> str:
    """Outcome of a case, in the words of this module's docstring."""
    if answer is None:
        return "no answer"
    if truth.level == "null":
        adequate = answer.verdict == "model_adequate"
        return "right" if adequate else "false alarm"
    if answer.verdict == "model_adequate":
        return "missed"
    if truth.level == "outside":
        return _judge_outside(answer)
    if len(truth.effects) > 1:
        return _judge_several(truth, answer)
    return _judge_single(truth, answer)


def _judge_outside(answer: Answer) -> str:
    listed = [k for k in answer.named if k[0] in EFFECTS]
    if not listed:
        return "right"
    sure = any(answer.probability.get(k, 1.0) >= CONFIDENT for k in listed)
    return "confident" if sure else "unsure"


def _judge_single(truth: Truth, answer: Answer) -> str:
    (true,) = truth.effects
    if answer.named and answer.named[0] == true:
        return "right" if len(answer.named) == 1 else "right first"
    first = answer.named[0] if answer.named else None
    for group in answer.groups:
        if true in group and (first is None or first in group):
            narrow = all(truth.alike(true, other) for other in group)
            if not narrow:
                return "wide group"
            return "look-alike" if len(answer.named) < 2 else "right first"
    if first is None:
        return "undecided"
    return "other place" if first[0] == true[0] else "wrong"


def _judge_several(truth: Truth, answer: Answer) -> str:
    left = list(truth.effects)
    wrong = 0
    for named in answer.named:
        meant = [t for t in left if t == named or _counts(truth, answer, named, t)]
        if meant:
            left.remove(meant[0])
        else:
            wrong += 1
    left = [t for t in left if not _is_listed_narrowly(truth, answer, t)]
    if not left:
        return "right" if not wrong else "right first"
    if not answer.named:
        return "undecided"
    return "half" if not wrong else "wrong"


def _is_listed_narrowly(truth: Truth, answer: Answer, true: Key) -> bool:
    """Whether the answer lists a true effect as indistinguishable from look-alikes alone."""
    return any(true in g and all(truth.alike(true, other) for other in g) for g in answer.groups)


def _counts(truth: Truth, answer: Answer, named: Key, true: Key) -> bool:
    return truth.alike(named, true) and answer.together(named, true)


@dataclass(frozen=True)
class Share:
    """hits of n, with the exact (Clopper-Pearson) 95 % interval of a binomial share."""

    hits: int
    n: int

    @property
    def value(self) -> float:
        """The share, NaN of none."""
        return self.hits / self.n if self.n else math.nan

    @property
    def interval(self) -> tuple[float, float]:
        """95 % interval; (0, 1) of none."""
        if not self.n:
            return 0.0, 1.0
        interval = binomtest(self.hits, self.n).proportion_ci(0.95, method="exact")
        return float(interval.low), float(interval.high)

    def __str__(self) -> str:
        if not self.n:
            return "–"
        low, high = self.interval
        whole = f"{100 * self.value:.0f} % ({100 * low:.0f} to {100 * high:.0f})"
        return f"{whole}, {self.hits} of {self.n}"


def share(outcomes: Iterable[bool]) -> Share:
    """Share of those that are true."""
    values = [bool(o) for o in outcomes]
    return Share(sum(values), len(values))


def quantile_text(values: Sequence[float], q: float, digits: int = 2) -> str:
    """A quantile with its distribution-free 95 % interval and the number of values."""
    finite = np.array([v for v in values if math.isfinite(v)])
    if not len(finite):
        return "–"
    bounds = quantile_test(finite, q=np.quantile(finite, q), p=q).confidence_interval(0.95)
    # an end that too few values leave open is not given a number
    low, high = (f"{x:.{digits}f}" if math.isfinite(x) else "?" for x in (bounds.low, bounds.high))
    return f"{np.quantile(finite, q):.{digits}f} ({low} to {high}), n = {len(finite)}"


@dataclass(frozen=True)
class Calibration:
    """Said probabilities against the share that was true, in bins of equal width.

    error: expected calibration error, weighted by the bins' counts, with a 95 % interval from
    cases drawn anew (bootstrap)
    """

    stated: np.ndarray
    true: tuple[Share, ...]
    error: float
    interval: tuple[float, float]
    n: int


def calibration(
    cases: Sequence[Sequence[tuple[float, bool]]], generator: np.random.Generator, *, bins: int = 10
) -> Calibration:
    """Calibration of probabilities.

    cases: (probability, whether it was true), a list a case;  generator: for the interval
    """
    flat = [np.array(c, dtype=float).reshape(-1, 2) for c in cases]
    pairs = np.concatenate([np.zeros((0, 2)), *flat])
    case = np.repeat(np.arange(len(flat)), [len(c) for c in flat])
    place = np.minimum((pairs[:, 0] * bins).astype(int), bins - 1)
    excess = np.zeros((len(flat), bins))
    np.add.at(excess, (case, place), pairs[:, 1] - pairs[:, 0])
    size = np.bincount(case, minlength=len(flat))

    def error(times: np.ndarray) -> np.ndarray:
        """Calibration error when each case counts so many times, (draws, cases)."""
        return np.abs(times @ excess).sum(axis=1) / np.maximum(times @ size, 1)

    low = high = whole = math.nan
    if len(pairs):
        whole = float(error(np.ones((1, len(flat))))[0])
        drawn = generator.multinomial(len(flat), np.full(len(flat), 1 / len(flat)), size=400)
        low, high = (float(q) for q in np.quantile(error(drawn), [0.025, 0.975]))
    filled = [b for b in range(bins) if (place == b).any()]
    return Calibration(
        stated=np.array([pairs[place == b, 0].mean() for b in filled]),
        true=tuple(share(pairs[place == b, 1] > 0.5) for b in filled),
        error=whole,
        interval=(low, high),
        n=len(pairs),
    )


@dataclass(frozen=True)
class Estimate:
    """A parameter of a found effect against the truth (SI)."""

    effect: str
    parameter: str
    true: float
    value: float
    stderr: float

    @property
    def inside(self) -> bool:
        """Whether the truth lies in the 95 % interval of the estimate."""
        return abs(self.value - self.true) <= norm.ppf(0.975) * self.stderr


def estimates(truth: Truth, answer: Answer) -> list[Estimate]:
    """Parameters of the true effects that were named, those with a standard error.

    A phase is compared on the circle.
    """
    rows = []
    for effect in truth.content["effects"]:
        if key(effect) not in answer.named:
            continue
        candidate = next((c for c in answer.content["candidates"] if key(c) == key(effect)), {})
        for name, estimate in candidate.get("parameters", {}).items():
            true = effect["parameters"].get(name, {}).get("value")
            if true is None or estimate["stderr"] is None or estimate["value"] is None:
                continue
            value = float(estimate["value"])
            if name == "phase":
                value = true + math.remainder(value - true, 2 * math.pi)
            rows.append(Estimate(effect["effect"], name, true, value, float(estimate["stderr"])))
    return rows
