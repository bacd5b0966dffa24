"""Claims about an identified device, alone, with a compensator or a virtual wall; and margins."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..base.sentences import round_down, round_near, round_up
from ..controllers import Controller, Stage
from ..diagrams import haptic_interface
from ..simulate import Sampling
from .identified import DIGITS, IdentifiedDevice
from .theorems import Question, TopicClaim, settle

#: N/m: a stiffness that gives ideal friction a length, for the strokes of a search
_RIGID = 1e5


@dataclass(frozen=True)
class Margin:
    """A limit of a design value, with its meaning in words.

    text: the meaning
    value: in `unit` (SI), rounded to the safe side: a design at the printed number is passive
    """

    text: str
    value: float
    unit: str

    def __str__(self) -> str:
        return f"{self.text}: {self.value:.4g} {self.unit}".rstrip()


def compensation_claims(
    device: IdentifiedDevice,
    law: Stage,
    *,
    computer: Sampling | None = None,
    rng: np.random.Generator | int = 0,
    tries: int = 15,
) -> list[TopicClaim]:
    """Claims about friction compensation, for all friction levels in the 95 % interval at once.

    law: a law of the catalogue that cancels friction, with its values
    computer: period, delay (whole periods) and encoder of the law; None: continuous time
    rng: draws the motions of a search in simulation, or the seed of the generator that does
    tries: number of these motions
    returns: claims by theorems, then one claim by the search
    """
    question = Question(device, law, computer=computer)
    lengths = question.lengths
    if device.presliding is None:
        lengths.append(device.lowest.estimate / _RIGID)
    stroke = round_near(100 * max(lengths), digits=3)
    by_search = TopicClaim.from_search(
        "search by simulation",
        "the device as simulated is passive",
        haptic_interface(device.body, cancellation=Controller((law,))),
        stroke=stroke,
        # a stroke takes a third of a second, or up to a hundred times that
        speed=round_near(10 * stroke, digits=3),
        rng=rng,
        computer=computer or "continuous",
        give=min(lengths) / 100,
        tries=tries,
    )
    return [*settle(question), by_search]


def _largest_command(device: IdentifiedDevice, force: float) -> float:
    """The largest command whose acting force is known to stay within a force, N."""
    command = force
    for _ in range(10):  # one is enough where the actuation is linear
        if (acting := device.acting_force(command)) <= force:
            return command
        command *= force / acting
    return 0.0


def margins(device: IdentifiedDevice, law: Stage | None = None) -> Sequence[Margin]:
    """Limits of design values within which the pair is passive.

    They hold for all values in the 95 % intervals, and the first one at the estimates. Empty or
    shorter where no limit is known.
    """
    if device.basis is not None and device.basis.is_open:
        return []  # friction may be less than any model of the records says
    force, stiff = map(device.unit, ("force", "stiffness"))
    lowest, presliding = device.lowest, device.presliding
    # what the actuation makes of a command is bounded, and beside ideal friction that is enough
    acts = presliding is None and math.isfinite(device.acting_force(lowest.low))
    left = [n for n in device.set_aside if not (acts and n in device.actuation)]
    alone = f", for friction without {', '.join(left)}" if left else ""

    def level(text: str, limit: float) -> Margin:
        """An upper limit of the level, rounded down to the digits of claims."""
        text = f"largest compensator level f_D {text}{alone}"
        limit = _largest_command(device, limit) if acts else limit
        return Margin(text, round_down(limit, digits=DIGITS), force)

    if device.basis is not None and not device.basis.is_adequate:
        # what is unexplained is in no estimate, nor in the damping
        return [level("for passivity in the covered cells", lowest.low)]
    limits = [
        level("for passivity at the estimates", lowest.estimate),
        level("for passivity at every level in the interval", lowest.low),
    ]
    if presliding is None:
        text = "that drives no motion, with viscous damping"
        return [*limits, level(text, device.least_resistance.low)]
    recoil = device.bristle_damping.high * (device.highest.high - lowest.low)
    if device.damping.low * lowest.low < recoil:
        return []  # no limit is known where the bristle's damping may release energy
    bristle = Question(device, law).bristle
    if law is not None and bristle is None:
        return []  # no limit is known for such a law on a contact that deflects
    f_d = min(bristle[0] if bristle else math.inf, lowest.low)
    softest = round_down(presliding.low * math.sqrt(f_d / device.highest.high), digits=DIGITS)
    limits.append(Margin(f"largest sigma_D at f_D = {f_d:.4g} {force}{alone}", softest, stiff))
    if bristle is not None:
        least = device.highest.high * (bristle[1] / presliding.low) ** 2
        least = round_up(least, digits=DIGITS)
        limits.append(
            Margin(f"least f_D at sigma_D = {bristle[1]:.4g} {stiff}{alone}", least, force)
        )
    return limits
