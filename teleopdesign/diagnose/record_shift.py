"""Clock of a logger: the delay of a body's force log against the log of its position.

A controller may write a command with the position that it answers, or with the next: a shift of up
to one row, either way, belongs to the record. It is no physics, but if it is ignored it looks like
a physical effect: a delay, a lag, the lead of a compliant transmission. So it is estimated with
every model, one shift for each body, common to all its records.

A shift that raises the error on the check records is held (`stated_fit.py`): with a model that
lacks much it may describe a part of a missing effect. It is held at zero, or at the shift of the
arm's other joints: one logger writes all of them.

Records may hardly determine the shift: a delay has the same effect, and with a spring and damper of
the controller viscous friction has. Then prior knowledge decides: most loggers are right, and none
is wrong by much more than a row. With a normal prior, the shift adds a row to the residual r of
each body,

    |r| d / (s sqrt(n)),    d: shift, s: the spread, n: independent observations

because then the least-squares values are the most probable ones, for a residual of unknown size: -2
log p = n log |r|^2 + (d / s)^2. Standard errors of all other parameters include the uncertainty of
the shift.

The log of a force may be late by more: buffers and batches hold commands back, sensors filter the
measured force. No motion precedes its force, so this is no missing effect, but structures would
imitate it. The log of a hand's force may also be late against the command, by the filter of its
sensor. This is estimated only where `stated_fit.py` says that it explains the residual.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..base.codec import At, Error, Number, Size
from ..base.frozen import ByValue
from ..base.sentences import with_standard_error
from ..blocks import Value
from ..measurement.filtering import Array
from ..measurement.prepare import Stretch
from ..measurement.record_clock import CLOCK
from ..model import Model
from ..realise.stages_along import INTERACTION_SHIFT, RECORD_SHIFT
from .simulated_course import dead_times


@dataclass(frozen=True)
class RecordShifts:
    """The k shifts that are estimated with a model on some stretches.

    logs: bodies with a command that changes, and "BODY.interaction_force" for hands' forces that
        may be late
    row: (k,) s between samples;  count: independent observations, n above
    spread: (k,) samples, standard deviation of the prior;  latest: (k,) samples, upper bound
    measured: (k,) whether the force was measured, not commanded
    held: (k,) whether the shift is not estimated; standard errors still include its uncertainty
    """

    logs: tuple[str, ...]
    row: Array
    count: int
    spread: Array
    latest: Array
    measured: NDArray[np.bool_]
    held: NDArray[np.bool_]

    @property
    def names(self) -> tuple[str, ...]:
        """Names (k,) by which tangents of the residual by the shifts are requested."""
        parts = (log.partition(".") for log in self.logs)
        return tuple(
            f"{body}.{INTERACTION_SHIFT if hand else RECORD_SHIFT}" for body, _, hand in parts
        )

    def start(self, model: Model) -> Array:
        """The model's shifts, in samples (k,)."""
        shifts = (model.record_shift.get(log) for log in self.logs)
        late = np.array([0.0 if shift is None else shift.value for shift in shifts])
        return np.clip(late / self.row, -CLOCK.early, self.latest)

    def at_bound(self, samples: Array) -> NDArray[np.bool_]:
        """Whether each of these shifts (k,), in samples, is at a bound of its range."""
        return np.abs(samples) >= CLOCK.near * np.where(samples > 0.0, self.latest, CLOCK.early)

    def beside(self, model: Model, samples: Array, errors: Array | None = None) -> Model:
        """The model with these shifts and their standard errors, both (k,) in samples."""
        stderr = np.full(len(samples), np.nan) if errors is None else errors
        shifts = {
            log: Value(float(x * row), bool(held), float(e * row))
            for log, x, row, e, held in zip(
                self.logs, samples, self.row, stderr, self.held, strict=True
            )
        }
        return model.with_record_shift({**model.record_shift, **shifts})

    def prior(self, samples: Array, residual: Array, jacobian: Array) -> tuple[Array, Array]:
        """Residual rows of the prior (k,), and their Jacobian (k, p + k).

        samples: (k,) shifts;  residual: (n,);  jacobian: (n, p + k), the shifts (in samples) last
        """
        size, part = self._size_and_part(residual)
        slope = np.outer(samples * part, residual @ jacobian / size)
        slope[:, jacobian.shape[1] - len(samples) :] += size * np.diag(part)
        return self.prior_alone(samples, residual), slope

    def prior_alone(self, samples: Array, residual: Array) -> Array:
        """Residual rows of the prior (k,), as in `prior`."""
        size, part = self._size_and_part(residual)
        return size * part * samples

    def _size_and_part(self, residual: Array) -> tuple[float, Array]:
        """Norm of a residual, and the part of it (k,) that a shift of one sample adds."""
        size = max(float(np.linalg.norm(residual)), 1e-300)
        return size, 1.0 / (self.spread * np.sqrt(self.count))

    def observed(
        self, residual: Array, jacobian: Array, blocks: NDArray[np.intp]
    ) -> tuple[Array, Array, NDArray[np.intp]]:
        """Jacobian, residual and blocks with the prior as k additional observations.

        The residual of each has its expected size, so standard errors include the spread of the
        prior.
        """
        k = len(self.logs)
        size = float(np.linalg.norm(residual)) / np.sqrt(self.count)
        rows = np.zeros((k, jacobian.shape[1]))
        rows[:, jacobian.shape[1] - k :] = np.diag(size / self.spread)
        first = int(blocks.max(initial=-1)) + 1
        return (
            np.vstack([jacobian, rows]),
            np.append(residual, np.full(k, size)),
            np.append(blocks, first + np.arange(k)),
        )


def record_shifts(
    stretches: Sequence[Stretch], count: int, model: Model | None = None
) -> RecordShifts:
    """The shifts to estimate on these stretches.

    count: independent observations in the stretches
    model: its fixed shifts are held; a hand's force has a shift only where the model has one; None:
        no shifts are held, and hands' forces have none
    """
    row: dict[str, float] = {}
    sensed: dict[str, bool] = {}
    late = {} if model is None else model.record_shift
    for s in stretches:
        hand = name_of_hand(s.motion.body)
        moves = np.ptp(s.motion.command) > 0.0 and not s.motion.is_curve
        if moves and not s.one_pass:
            row[s.motion.body] = min(s.row, row.get(s.motion.body, np.inf))
            sensed[s.motion.body] = s.force_is_sensed
        if hand in late:
            row[hand], sensed[hand] = min(s.row, row.get(hand, np.inf)), True
    held = np.array([log in late and late[log].fixed for log in row], dtype=bool)
    rows, measured = np.array(list(row.values())), np.array(list(sensed.values()), dtype=bool)
    return RecordShifts(
        tuple(row),
        rows,
        max(count, 1),
        np.maximum(CLOCK.spread, measured * CLOCK.sensor_spread / rows),
        np.maximum(CLOCK.early, CLOCK.latest / rows),
        measured,
        held,
    )


def name_of_hand(body: str) -> str:
    """The name of the log of a hand's force on a body, as in `Model.record_shift`."""
    return f"{body}.interaction_force"


@dataclass(frozen=True, eq=False)
class RecordShift(ByValue):
    """Delay of the log of a body's force, as estimated by a fitted model.

    at: the body, or `name_of_hand` of it
    late, stderr: s, positive: the log is late;  row: s between samples
    may_delay: whether the model has a dead time there
    latest: s by which the log may be late
    measured: whether the force was measured, not commanded
    held: whether it is the shift of the arm's other joints
    """

    at: str
    late: Annotated[Number, At("value")]
    stderr: Error
    row: Size
    may_delay: bool
    latest: Size
    measured: bool
    held: bool = False

    ALSO_WRITTEN: ClassVar[Mapping[str, str]] = {
        "unit": "unit",
        "rows": "rows",
        "at_bound": "at_bound",
        "like_a_delay": "is_like_a_delay",
    }

    @property
    def unit(self) -> str:
        """Unit of the delay."""
        return "s"

    @property
    def rows(self) -> float:
        """The delay in rows of the record."""
        return self.late / self.row

    @property
    def at_bound(self) -> bool:
        """Whether the shift is as large as a logger's may be."""
        most = self.latest if self.late > 0.0 else CLOCK.early * self.row
        return abs(self.late) >= CLOCK.near * most

    @property
    def is_like_a_delay(self) -> bool:
        """Whether a delay of less than a row would have the same effect on the records."""
        early = -self.late > max(
            CLOCK.reported_rows * self.row, CLOCK.reported_errors * self.stderr
        )
        return self.may_delay or early

    def __str__(self) -> str:
        rows, error = self.rows, self.stderr / self.row
        word = "late" if rows >= 0 else "early"
        size = with_standard_error(abs(rows), error) if error > 0.0 else f"{abs(rows):.2f}"
        body, _, hand = self.at.partition(".")
        what = "force of the hand" if hand else "command"
        text = f"clock of the records: {what} at {body} {size} rows {word}"
        text += f" ({1e3 * self.late:.3g} ms)"
        if self.held:
            text += ", as at the other joints"
        if self.at_bound and self.late < 0.0:
            return f"{text}, at its bound: a longer shift counts as physics"
        if self.late > CLOCK.early * self.row:
            late = "the force was measured, and the filter of its sensor has this effect"
            if not self.measured:
                late = "no machine moves before its command, so the log is late"
            if self.at_bound:
                late = "at its bound: an effect that the model lacks may have this effect"
            return f"{text}; {late}"
        if self.is_like_a_delay:
            return f"{text}; a delay of less than a row looks the same"
        return text


def shifts_of(model: Model, stretches: Sequence[Stretch]) -> tuple[RecordShift, ...]:
    """The shifts of records that a fitted model has, except those held at zero."""
    shifts = record_shifts(stretches, 1, model)
    late = model.record_shift
    return tuple(
        RecordShift(
            at=log,
            late=late[log].value,
            stderr=late[log].stderr,
            row=float(row),
            may_delay=log in model.bodies and bool(dead_times(model.body(log))),
            latest=float(row * latest),
            measured=bool(measured),
            held=late[log].fixed,
        )
        for log, row, latest, measured in zip(
            shifts.logs, shifts.row, shifts.latest, shifts.measured, strict=True
        )
        if log in late and not (late[log].fixed and late[log].value == 0.0)
    )
