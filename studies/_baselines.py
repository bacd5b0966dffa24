"""PySINDy and SysIdentPy on the cases' own files: which effect do their sparse models name?

Both get the same library of terms (`_terms.py`), one body at a time, and choose columns of it from
the fit record in their own way. What follows is the same for both. An effect counts as chosen if
any of its columns is. Effects are ordered by how much the check record's squares grow without them.
The choice stands only if it lowers these by more than chance; else the model is called adequate. A
delay and a lag share their terms; the ratio of the two coefficients tells them apart. No
probability is stated, so that a name counts as said with confidence.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from _terms import ALIKE, CONTACT, WITH_MEMORY, Array, Library, libraries
from numpy.typing import NDArray

from teleopdesign.diagnose.evidence import gain_score

#: blocks of the fit record that are held out in turn
FOLDS = 5
#: smallest contribution of a kept column, relative to the target's rms: from next to nothing to all
THRESHOLDS = np.geomspace(0.01, 1.0, 15)
#: most regressors that the forward regression is asked about
MOST_TERMS = 14
#: rows of the check record in a block that counts as one independent sample (0.5 s at 60 Hz)
BLOCK = 75
#: standard deviations by which the check record must gain
SURE = 3.0
#: a delay acts as u - tau u' + tau^2/2 u'' ..., a lag as u - tau u' + tau^2 u'' ...: half-way
LAG_FROM = 0.75

#: method -> effects that none of its terms can express
CANNOT = {"pysindy": WITH_MEMORY, "sysidentpy": WITH_MEMORY}


def pysindy_columns(lib: Library) -> NDArray[np.intp]:
    """Columns that STLSQ keeps, at the largest threshold within a standard error of the best."""
    from pysindy import STLSQ

    y = lib.fit_target / np.sqrt(np.mean(lib.fit_target**2))
    fold = np.arange(len(y)) * FOLDS // len(y)
    training = [_compressed(lib.fit[fold != k], y[fold != k]) for k in range(FOLDS)]
    errors = np.empty((len(THRESHOLDS) + 1, FOLDS))
    for i, threshold in enumerate([*THRESHOLDS, np.inf]):
        for k in range(FOLDS):
            columns = _stlsq(STLSQ, *training[k], threshold)
            unseen = fold == k
            left = y[unseen] - lib.fit[unseen][:, columns] @ _solve(
                training[k][0], columns, training[k][1]
            )
            errors[i, k] = np.mean(left**2)
    mean = errors.mean(axis=1)
    best = int(np.argmin(mean))
    allowed = mean[best] + errors[best].std(ddof=1) / np.sqrt(FOLDS)
    chosen = int(np.flatnonzero(mean <= allowed).max())
    return _stlsq(STLSQ, *_compressed(lib.fit, y), [*THRESHOLDS, np.inf][chosen])


def _compressed(columns: Array, y: Array) -> tuple[Array, Array]:
    """As few rows with the same least-squares solutions for every choice of columns."""
    triangle = np.linalg.qr(np.column_stack([columns, y]), mode="r")
    return triangle[:, :-1], triangle[:, -1]


def _stlsq(method: Any, columns: Array, y: Array, threshold: float) -> NDArray[np.intp]:
    if not np.isfinite(threshold):
        return np.zeros(0, dtype=np.intp)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that nothing is left, which is an answer
        fit = method(threshold=threshold, alpha=1e-6).fit(columns, y[:, None])
    return np.flatnonzero(np.asarray(fit.coef_)[0])


def sysidentpy_columns(lib: Library) -> NDArray[np.intp]:
    """Terms that FROLS puts into a NARX model with two past outputs, by the Bayesian criterion."""
    from sysidentpy.basis_function import Polynomial
    from sysidentpy.model_structure_selection import FROLS
    from sysidentpy.parameter_estimation import LeastSquares

    terms = lib.fit.shape[1]
    model = FROLS(
        ylag=2,
        xlag=[[1]] * terms,
        order_selection=True,
        n_info_values=min(MOST_TERMS, terms),
        info_criteria="bic",
        estimator=LeastSquares(),
        basis_function=Polynomial(degree=1),  # what is not linear is in the terms
        model_type="NARMAX",
    )
    ahead = np.roll(lib.fit, -1, axis=0)  # its lags of inputs begin at one row
    model.fit(X=ahead[:-1], y=lib.fit_target[:-1, None])
    # a regressor's code: 0 the constant, 1000 + lag the output, 1000 (2 + i) + lag the i-th term
    codes = np.asarray(model.final_model)[:, 0]
    return np.array([c // 1000 - 2 for c in codes if c >= 2000], dtype=np.intp)


def _solve(columns: Array, chosen: NDArray[np.intp], y: Array) -> Array:
    return np.linalg.lstsq(columns[:, chosen], y, rcond=1e-9)[0]


@dataclass(frozen=True)
class Named:
    """An effect with what the check record's squares grow by without it."""

    effect: str
    at: str
    gain: float


def _left(lib: Library, chosen: NDArray[np.intp]) -> Array:
    """What is left on the check rows when these columns are fitted on the fit rows."""
    return lib.check_target - lib.check[:, chosen] @ _solve(lib.fit, chosen, lib.fit_target)


def name_effects(lib: Library, columns: NDArray[np.intp]) -> list[Named]:
    """The effects of the chosen columns, unless the check record says that they explain nothing."""
    effects = list(dict.fromkeys(lib.effect[i] for i in columns))
    if not effects:
        return []
    with_all = _left(lib, lib.of(*effects))
    blocks = np.arange(len(with_all)) // BLOCK
    if gain_score(lib.check_target, with_all, blocks) <= SURE:
        return []
    effects_named = []
    for effect in effects:
        without = _left(lib, lib.of(*(e for e in effects if e != effect)))
        gain = float(without @ without - with_all @ with_all)
        effects_named.append(Named(_delay_or_lag(lib, effect, effects), _place(lib, effect), gain))
    return [n for n in effects_named if n.gain > 0]


def _place(lib: Library, effect: str) -> str:
    return "environment" if effect in CONTACT else lib.body


def _delay_or_lag(lib: Library, effect: str, effects: list[str]) -> str:
    """A delay or a lag, by the ratio of second coefficient to squared first one."""
    if effect != "actuation_delay":
        return effect
    columns = lib.of(*effects)
    coefficient = _solve(lib.fit, columns, lib.fit_target) / lib.size[columns]
    first, second = coefficient[[lib.effect[i] == effect for i in columns]]
    return "actuator_lag" if -second / first**2 > LAG_FROM else effect


def answer(folder: Path, choose: Callable[[Library], NDArray[np.intp]]) -> dict[str, Any]:
    """The answer to a case in the form of `teleopdesign diagnose`, without probabilities."""
    named: list[Named] = []
    for lib in libraries(folder):
        named += name_effects(lib, choose(lib))
    named.sort(key=lambda n: -n.gain)
    missing = [{"effect": n.effect, "at": n.at} for n in named]
    alike = [[m, m | {"effect": ALIKE[m["effect"]]}] for m in missing if m["effect"] in ALIKE]
    return {
        "verdict": "effects_missing" if missing else "model_adequate",
        "missing": missing,
        "gains": [n.gain for n in named],
        "indistinguishable": alike,
        "candidates": [],
    }


BASELINES: dict[str, Callable[[Path], dict[str, Any]]] = {
    "pysindy": lambda folder: answer(folder, pysindy_columns),
    "sysidentpy": lambda folder: answer(folder, sysidentpy_columns),
}
