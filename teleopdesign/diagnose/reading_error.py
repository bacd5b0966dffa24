"""Effect of sensor readings on estimates: their spread and their bias.

Where readings show no direction, friction may have any value up to its level, so noise changes it
to one side only. Noise in an acceleration makes an estimated inertia smaller. Such shifts are
small, but larger than residuals suggest, because residuals are smallest at the optimum. So the
final model is simulated along the records. Its true parameters are known. The stated sensors read
its motion, and the parameters are estimated from these readings. The error of this estimate is that
of the first estimate (a parametric bootstrap: Efron, Tibshirani, An Introduction to the Bootstrap,
1993, chapters 6 and 10). Where the error is large, it is estimated again at the corrected values,
until they agree (indirect inference: Gourieroux, Monfort, Renault, J. Applied Econometrics 8,
1993). An example is a tip that resonates within the bandwidth: noise makes its damping look larger.
"""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from ..base.errors import ModelError
from ..measurement.filtering import Array
from ..measurement.prepare import Prepared, Stretch, stretch_of
from ..model import Model
from ..realise.bristle import UNDAMPED
from .cores import map_in_threads
from .criteria import CRITERIA
from .fit import Fit, estimate
from .noise_floor import read_again
from .record_offsets import apply_record_offsets
from .search_plan import EFFORTS
from .simulated_course import as_led, dead_times, simulated_course, with_whole_dead_times
from .solve import solve, spans_decades

#: bristle lengths of an ideal friction, in encoder steps, and damping ratios. An encoder cannot
#: read such a length, so each pair is simulated. With the longest bristle, reversals look like
#: friction with memory; with the shortest one the contact breaks away at once; damping resists
#: every change of the contact. A ratio of 0 is Dahl friction; the authors of LuGre chose 0.5:
#: stiffness 1e5 N/m, damping sqrt(1e5) N s/m at 1 kg. `UNDAMPED` stands for 0: then both ratios
#: share one loop, which takes 2.5 s to compile
BRISTLE_STEPS, DAMPED = (0.3, 0.1, 0.03), (UNDAMPED, 0.5)
#: most successive simulations, while the shift still changes by more than its error
ROUNDS = 4


@dataclass(frozen=True)
class ReadingError:
    """Bias and spread (p,) that readings cause in the free parameters, in `coordinates`."""

    shift: Array
    spread: Array


def _decades(model: Model, names: tuple[str, ...]) -> Array:
    return np.array([spans_decades(model, n) for n in names], dtype=bool)


def coordinates(model: Model, names: tuple[str, ...]) -> Array:
    """Values (p,) of parameters; logarithms of those that are estimated over decades."""
    values = np.array([model.parameters[n].value for n in names], dtype=float)
    decades = _decades(model, names)
    values[decades] = np.log(np.maximum(values[decades], 1e-300))
    return values


def reading_error(
    fit: Fit, prepared: Prepared, generator: np.random.Generator
) -> ReadingError | None:
    """Errors of the estimates from simulated readings, for which the true values are known.

    returns: None where the motion of the model cannot be simulated, or an estimate is not finite
    """
    # the simulated records have no late log
    truth = _with_whole_dead_times(fit.model.with_record_shift({}), prepared)
    true = coordinates(truth, fit.free)
    made = [_simulate_records(truth, prepared, g, d) for g, d in product(BRISTLE_STEPS, DAMPED)]
    exact = [stretches for stretches in made if stretches is not None]
    if len(exact) < len(made):
        return None

    def missed(stretches: list[Stretch], noise: np.random.Generator) -> Array:
        drawn = [as_read(s, prepared, noise) for s in stretches]
        again = replace(prepared, stretches=tuple(drawn))
        solution = solve(truth, again, EFFORTS.again)
        by = coordinates(solution.model, fit.free) - true
        for i, name in enumerate(fit.free):
            if truth.declared(name).quantity == "angle":
                by[i] = (by[i] + np.pi) % (2.0 * np.pi) - np.pi
        return by

    steps = np.array(map_in_threads(missed, exact, generator.spawn(len(exact))))
    if not np.isfinite(steps).all():
        return None
    return ReadingError(np.median(steps, axis=0), steps.std(axis=0, ddof=1))


def _with_whole_dead_times(model: Model, prepared: Prepared) -> Model:
    """The model with its dead times rounded to the grid of the simulation."""
    for stretch in prepared.of("fit"):
        place = stretch.motion.body
        rounded = with_whole_dead_times(model.body(place), stretch.motion).parameters
        late = dead_times(model.body(place))
        model = model.with_values({f"{place}.{n}": rounded[n].value for n in late})
    return model


def _simulate_records(
    model: Model, prepared: Prepared, deflection: float, damping_ratio: float
) -> list[Stretch] | None:
    """The fit records with simulated motions of the model in place of the recorded ones.

    deflection: bristle length in encoder steps;  returns: None where the model has no simulated
        motion near the record
    """
    stretches = list(prepared.of("fit"))
    made = []
    for stretch, (body, motion) in zip(
        stretches, apply_record_offsets(model, stretches), strict=True
    ):
        try:
            course = simulated_course(
                body, motion, deflection=deflection, damping_ratio=damping_ratio
            )
        except ModelError:
            return None
        if not course.stays_near(motion):
            return None
        made.append(replace(stretch, motion=as_led(motion, course)))
    return made


def as_read(stretch: Stretch, prepared: Prepared, generator: np.random.Generator) -> Stretch:
    """A stretch of exact signals as the sensors would read it."""
    motion = read_again(stretch, prepared, generator)
    return stretch_of(motion, stretch.use, prepared.bandwidth, stretch.offset_names)


def _subtract_shift(fit: Fit, shift: Array) -> tuple[Model, Array]:
    """The model of a fit with the shift subtracted, and a mask (p,) of the estimates that changed.

    Estimates at a bound do not change, nor those that the shift would move out of bounds or to
    another magnitude.
    """
    model, moved = fit.model, np.zeros(len(fit.free), dtype=bool)
    there = coordinates(model, fit.free) - shift
    decades, largest = _decades(model, fit.free), CRITERIA.open_error
    there[decades] = np.exp(np.minimum(there[decades], 700.0))
    for i, name in enumerate(fit.free):
        declared = model.declared(name)
        # a larger shift is no better known than an open parameter
        small = abs(shift[i]) < largest * (1.0 if decades[i] else model.from_absence(name))
        if declared.quantity == "angle":
            small = abs(shift[i]) < largest
        inside = declared.lower <= there[i] <= declared.upper
        moved[i] = small and inside and name not in fit.at_bound
        if not moved[i]:
            there[i] = model.parameters[name].value
    return model.with_values(dict(zip(fit.free, there, strict=True))), moved


def _converge(
    fit: Fit, error: ReadingError, prepared: Prepared, generator: np.random.Generator
) -> tuple[ReadingError, Model, Array]:
    """The reading error at the corrected values, the model there, and a mask (p,) of changes.

    generator: copied for each simulation, so that only the values differ
    """
    values = np.array([fit.model.parameters[n].value for n in fit.free])
    errors = np.array([fit.model.parameters[n].stderr for n in fit.free])
    relative_errors = np.nan_to_num(
        errors / np.where(_decades(fit.model, fit.free), values, 1.0), nan=np.inf
    )
    before = np.zeros(len(values))
    model, moved = _subtract_shift(fit, error.shift)
    for _ in range(ROUNDS - 1):
        if np.all(
            np.abs(error.shift - before)[moved] <= np.hypot(relative_errors, error.spread)[moved]
        ):
            break
        there = replace(fit, model=model)
        again = reading_error(there, prepared, deepcopy(generator))
        if again is None:
            break
        before, error = error.shift, again
        model, moved = _subtract_shift(fit, error.shift)
    return error, model, moved


def with_reading_error(
    fit: Fit,
    prepared: Prepared,
    generator: np.random.Generator,
    *,
    adequate: Callable[[Fit], bool],
) -> Fit:
    """The fit with the bias of its readings removed and standard errors that include their spread.

    adequate: whether a fit leaves only noise
    The bias is not removed where the fit or the corrected fit is not adequate, nor from estimates
    that would move to another magnitude. It widens their standard errors instead.
    returns: the fit unchanged where its motion cannot be simulated
    """
    if not fit.free:
        return fit
    error = reading_error(fit, prepared, deepcopy(generator))
    if error is None:
        return fit
    better, moved = fit, np.zeros(len(fit.free), dtype=bool)
    if adequate(fit):
        error, model, shifted = _converge(fit, error, prepared, generator)
        again = estimate(model, prepared, effort=EFFORTS.evaluation)
        if adequate(again):
            better, moved = again, shifted
    more = np.hypot(error.spread, np.where(moved, 0.0, error.shift))
    values = np.array([fit.model.parameters[n].value for n in fit.free])
    more = more * np.where(_decades(fit.model, fit.free), values, 1.0)
    parameters, errors = better.model.parameters, fit.model.parameters
    wide = {
        n: replace(parameters[n], stderr=float(np.hypot(errors[n].stderr, e)))
        for n, e in zip(fit.free, more, strict=True)
    }
    return replace(better, model=better.model.with_values(wide))
