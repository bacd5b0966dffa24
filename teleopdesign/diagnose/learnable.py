"""Learnable force: the part of the residual that boosted trees predict from the motion alone.

The inputs are position, velocity, acceleration, direction, time and travel since the last reversal;
the target is the low-passed residual. The trees predict records that they were not trained on. So
the predicted force is a function of the motion, whatever its law. The rest does not repeat, or
depends on quantities that were not measured, or on the motion in a way that these records are too
few to teach. A complete model leaves at most this rest, and at least the noise floor.

At a joint of an arm the inputs are the motions of all joints, because the joints are coupled. The
commanded force is no input: otherwise it would be predicted from itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from ..base.codec import At, Size
from ..base.sentences import percent
from ..base.units import unit_of
from ..measurement.filtering import Array
from ..measurement.friction_curve import FOLDS
from ..measurement.motion import Motion
from ..measurement.prepare import Prepared, Stretch, measured_force
from ..measurement.reversals import look_back_to_reversal
from ..model import Model
from .candidates import tells_place_from_time
from .error import error_of, mark_near_reversals
from .fit import estimate
from .folds import folds, with_rows
from .record_offsets import apply_record_offsets
from .residual import residuals
from .search_plan import EFFORTS

#: most rows that the trees learn from, spread evenly: more rows take time and add little
MOST_ROWS = 20_000
#: number of trees, learning rate, leaves, and fewest rows a leaf: as in scikit-learn, with leaves
#: twice as large, because neighbouring rows are not independent. No number is tuned
TREES, RATE, LEAVES, ROWS_OF_A_LEAF = 150, 0.08, 31, 40
#: s without sure motion after which a motion counts as a new start, even in the same direction
REST = 0.5
#: a place is named if its part of the learned force exceeds its part of the rows by more than this;
#: otherwise the learned force is spread over all places
EXCESS_OF_A_PLACE = 0.2


@dataclass(frozen=True)
class Learnable:
    """Relative errors with a black box that knows the motion only, on records not used in training.

    left: check error of the model;  error: check error of the model and the black box together
    alone: check error of a black box without any model
    where: where most of the learned force lies, in words; "": everywhere, or nothing is learned
    """

    error: Annotated[Size, At("learnable")]
    left: Annotated[Size, At("black_box.left")]
    alone: Annotated[Size, At("black_box.alone")]
    where: Annotated[str, At("black_box.where")] = ""

    @property
    def part(self) -> float:
        """Part of the error that could be learned: left - error, at least zero."""
        return max(self.left - self.error, 0.0)

    def __str__(self) -> str:
        left, rest = (percent(e, ".2g") for e in (self.left, min(self.error, self.left)))
        if not self.part > 0.0:
            return f"{left} left; nothing was learned from the motion"
        where = f", {self.where}" if self.where else ""
        return (
            f"{left} left; {percent(self.part, '.2g')} follows from the motion{where}; "
            f"{rest} was not learned"
        )


def is_installed() -> bool:
    """Whether the optional package for trees (extra `learn`) is installed."""
    return find_spec("sklearn") is not None


def learnable(
    model: Model,
    prepared: Prepared,
    *,
    beside: Sequence[Sequence[Motion]] = (),
    seed: int = 0,
) -> Learnable | None:
    """The part of a model's residual that could be learned; None without the extra `learn`.

    Trees predict groups of check records after training on all other records. Without check
    records, blocks of the fit records are held out in turn.

    beside: of each stretch, the motions of the arm's other joints at the same rows
    seed: of the random numbers of the trees
    """
    if not is_installed():
        return None
    import sklearn.ensemble  # noqa: F401  loaded first: only then can its threads be limited

    # with more threads, those of the trees and of other callers would wait actively for each other
    with threadpool_limits(limits=1, user_api="openmp"):
        return _measure_learnable(model, prepared, beside, seed)


def _measure_learnable(
    model: Model, prepared: Prepared, beside: Sequence[Sequence[Motion]], seed: int
) -> Learnable:
    stretches = prepared.stretches  # without check records all are fit records
    measured = [measured_force(s) for s in stretches]
    held_out: list[Stretch] = []
    before: list[Array] = []
    after: list[Array] = []
    alone: list[Array] = []
    for held, there in _turns(model, prepared, stretches):
        motions = [motion for _, motion in apply_record_offsets(there, stretches)]
        inputs = _inputs_along(motions, beside)
        left = [r for r, _ in residuals(there, stretches)]
        of_rest = _predict_held_out(stretches, inputs, left, held, seed)
        of_force = _predict_held_out(stretches, inputs, measured, held, seed)
        held_out += [with_rows(s, rows) for s, rows in zip(stretches, held, strict=True)]
        before += [r[rows] for r, rows in zip(left, held, strict=True)]
        after += [r[rows] - p for r, rows, p in zip(left, held, of_rest, strict=True)]
        alone += [f[rows] - p for f, rows, p in zip(measured, held, of_force, strict=True)]
    gain = [b**2 - a**2 for b, a in zip(before, after, strict=True)]
    return Learnable(
        left=error_of(held_out, before),
        error=error_of(held_out, after),
        alone=error_of(held_out, alone),
        where=_where(model, held_out, gain),
    )


def _turns(
    model: Model, prepared: Prepared, stretches: Sequence[Stretch]
) -> Iterator[tuple[list[NDArray[np.bool_]], Model]]:
    """For each turn: a mask of held-out rows of each stretch's `keep`, and the model for them.

    Without check records the model of each turn is estimated again without those rows.
    """
    files = list(dict.fromkeys(s.motion.file for s in stretches if s.use == "check"))
    for group in (set(files[i::FOLDS]) for i in range(min(FOLDS, len(files)))):
        yield [np.full(len(s.keep), s.motion.file in group) for s in stretches], model
    if files:
        return
    ends = np.cumsum([len(s.keep) for s in stretches])[:-1]
    for fold in folds(stretches):
        as_check = tuple(replace(s, use="check") for s in fold.held_out)
        turn = replace(prepared, stretches=(*fold.known, *as_check))
        there = estimate(model, turn, effort=EFFORTS.held_out).model
        yield np.split(fold.rows, ends), there


def _predict_held_out(
    stretches: Sequence[Stretch],
    inputs: Sequence[Array],
    targets: Sequence[Array],
    held: Sequence[NDArray[np.bool_]],
    seed: int,
) -> list[Array]:
    """The predicted target on the held-out rows, low-passed like the error.

    The trees of a body are trained on its other rows.
    """
    predicted = [np.zeros(int(rows.sum())) for rows in held]
    for body in {s.motion.body for s in stretches}:
        mine = [i for i, s in enumerate(stretches) if s.motion.body == body]
        known = np.concatenate([inputs[i][stretches[i].keep[~held[i]]] for i in mine])
        target = np.concatenate([targets[i][~held[i]] for i in mine])
        every = max(1, -(-len(target) // MOST_ROWS))
        if not len(target):
            continue
        trees = _trees(known[::every], target[::every], seed)
        for i in mine:
            if held[i].any():
                motion, rows = stretches[i].motion, stretches[i].keep[held[i]]
                predicted[i] = motion.lowpassed(trees(inputs[i]))[rows]
    return predicted


def _trees(inputs: Array, target: Array, seed: int) -> Callable[[Array], Array]:
    """Prediction by boosted trees trained on the target (n,) with inputs (n, k)."""
    from sklearn.ensemble import HistGradientBoostingRegressor

    trees = HistGradientBoostingRegressor(
        max_iter=TREES,
        learning_rate=RATE,
        max_leaf_nodes=LEAVES,
        min_samples_leaf=ROWS_OF_A_LEAF,
        early_stopping=False,
        random_state=seed,
    )
    varies = np.ptp(inputs, axis=0) > 0.0  # the trees find no borders in a signal that is constant
    if not varies.any():
        mean = float(np.mean(target))
        return lambda along: np.full(len(along), mean)
    trees.fit(inputs[:, varies], target)
    return lambda along: np.asarray(trees.predict(along[:, varies]))


def _where(model: Model, stretches: Sequence[Stretch], gain: Sequence[Array]) -> str:
    """Where most of the gain lies, in words: range of speeds, and reversals; "": nowhere special.

    gain: decrease of the squared residual in each row
    """
    weight = np.concatenate([np.full(len(s.keep), s.weight) for s in stretches])
    each = weight * np.concatenate(gain)
    if not each.sum() > 0.0:
        return ""
    speed = np.concatenate([np.abs(s.motion.velocity[s.keep]) for s in stretches])
    near = np.concatenate([mark_near_reversals(s.motion)[s.keep] for s in stretches])

    def excess(rows: NDArray[np.bool_]) -> float:
        """Share of the gain in these rows, less their share of all rows."""
        return float(each[rows].sum() / each.sum() - weight[rows].sum() / weight.sum())

    axes = {model.body(s.motion.body).axis for s in stretches}
    words = []
    if len(axes) == 1:
        unit = unit_of("velocity", axes.pop())
        borders = np.quantile(speed, np.linspace(0.1, 0.9, 9))
        excesses = [excess(speed < border) for border in borders]
        if max(excesses) > EXCESS_OF_A_PLACE:
            words.append(f"below {borders[int(np.argmax(excesses))]:.2g} {unit}")
        elif -min(excesses) > EXCESS_OF_A_PLACE:
            words.append(f"above {borders[int(np.argmin(excesses))]:.2g} {unit}")
    if excess(near) > EXCESS_OF_A_PLACE:
        words.append("around reversals")
    return " ".join(words)


def _inputs_along(
    motions: Sequence[Motion], beside: Sequence[Sequence[Motion]] = ()
) -> list[Array]:
    """Inputs of the trees (n, k), for each motion; further measured channels are inputs too.

    beside: for each motion, those of an arm's other joints at the same times
    """
    if beside:  # the other motion of a joint is the motion of one of these
        motions = [replace(m, further=_without_other_motion(m)) for m in motions]
    inputs = [_columns_of_body(m, [o for o in motions if o.body == m.body]) for m in motions]
    if not beside:
        return inputs
    with_place = [tells_place_from_time(of_one) for of_one in zip(*beside, strict=True)]
    return [
        np.column_stack([mine, *_columns_of_others(others, with_place)])
        for mine, others in zip(inputs, beside, strict=True)
    ]


def _without_other_motion(motion: Motion) -> dict[str, Array]:
    return {n: x for n, x in motion.further.items() if not n.startswith("other_")}


def _columns_of_body(motion: Motion, motions: Sequence[Motion]) -> Array:
    """Inputs from the motion of the body itself (n, k); NaN before the first certain motion.

    motions: all motions of that body. Where none returns to a place, or none reverses, position or
        time since a reversal would reveal the time, and with it the recorded command
    """
    since = look_back_to_reversal(
        motion.direction, motion.position, sample_time=motion.sample_time, rest=REST
    )
    columns: list[Array] = [motion.velocity, motion.acceleration, motion.direction.astype(float)]
    if tells_place_from_time(motions):
        columns.append(motion.position)
    if any({-1, 1} <= set(m.direction.tolist()) for m in motions):
        columns += [np.where(since.known, x, np.nan) for x in (since.time, since.travel)]
    return np.column_stack([*columns, *motion.further.values()])


def _columns_of_others(motions: Sequence[Motion], with_place: Sequence[bool]) -> list[Array]:
    """Inputs from the motions of the other joints at the same times, columns (n,).

    with_place: for each joint, whether its position does not reveal the time
    """
    columns: list[Array] = []
    for motion, has_place in zip(motions, with_place, strict=True):
        columns += [motion.velocity, motion.acceleration, motion.direction.astype(float)]
        columns += [motion.position] * has_place
    return columns
