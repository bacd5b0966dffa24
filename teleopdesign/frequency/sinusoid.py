"""A diagram driven by a sinusoid until its cycles repeat.

Lock-in: the first harmonic of a periodic signal, and the harmonics above it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np

from ..base.errors import ModelError, did_you_mean
from ..diagrams import Diagram, Junction
from ..simulate import Sampling, Setup, prepare, sine
from ..simulate.sampling import SAMPLED

#: deflection of ideal Coulomb friction before it slides, as a share of the amplitude. Its remaining
#: spring force, 1.25 sqrt(share) of the friction (P18), turns the phase of friction by 0.2 degrees
BRISTLE_SHARE = 1e-5
#: inner steps in which such a bristle is reloaded after a reversal: one more than the kernel needs
_RELOAD_STEPS = 11
#: at least that many inner steps a cycle, also where nothing slides
_LEAST_STEPS = 400
#: cycles of the first run, and the largest factor on them in later runs
_CYCLES, _MOST_LONGER = 4, 32


@dataclass(frozen=True)
class Sinusoid:
    """The sinusoid that drives a diagram.

    drive: a motion (prescribed), or a signal from outside;  amplitude: in its unit;  frequency: Hz
    computer: how controllers are sampled, see `simulate`
    give: share of the amplitude (of the motion) by which ideal Coulomb friction deflects
    tolerance: relative difference of cycles at which a first harmonic counts as steady; the
        remaining change by a transient that loses a quarter over half the run is three times that
    """

    drive: str
    amplitude: float
    frequency: float
    computer: Sampling | Literal["continuous"] = SAMPLED
    give: float = BRISTLE_SHARE
    tolerance: float = 3e-4


def steady_harmonics(
    diagram: Diagram, drive: Sinusoid, *, signals: tuple[str, ...]
) -> dict[str, Harmonic]:
    """First harmonics of signals once their cycles repeat; phases relative to the drive.

    Runs four cycles, then twice as many, up to 128, until the last cycles agree. `unsettled` of a
    harmonic shows the remaining difference.

    raises ModelError: drive is neither a motion nor from outside, or an unknown signal
    """
    for name in signals:
        diagram.signal(name)
    cycles = _CYCLES
    while True:
        setup = _set_up(diagram, drive, duration=cycles / drive.frequency)
        rows, timing = setup.run_resolved(long_step="refine", every_step=True)
        columns = dict(zip(setup.program.layout.columns, rows.T, strict=True))
        columns = _outside_signals(diagram, drive, len(rows), timing.step) | columns
        harmonics = {
            name: lock_in(
                _signal(diagram, columns, name),
                step=timing.step,
                frequency=drive.frequency,
                points=round(1 / (drive.frequency * timing.step)),
            )
            for name in signals
        }
        worst = max(h.unsettled for h in harmonics.values())
        if worst <= drive.tolerance or cycles >= _CYCLES * _MOST_LONGER:
            return harmonics
        cycles *= 2


def _set_up(diagram: Diagram, drive: Sinusoid, *, duration: float) -> Setup:
    omega = 2 * np.pi * drive.frequency
    motion = sine(amplitude=drive.amplitude, frequency=drive.frequency)
    prescribed = drive.drive in {b.motion for b in diagram.moving}
    if not prescribed and drive.drive not in diagram.outside:
        known = [b.motion for b in diagram.moving] + [*diagram.outside]
        raise ModelError(
            f'{diagram.name}: "{drive.drive}" cannot be driven, found {", ".join(known)}'
            f"{did_you_mean(drive.drive, known)}"
        )
    # reloading takes sqrt(2 lambda/a), lambda = give A and a = A omega^2
    step = min(np.sqrt(2 * drive.give) / _RELOAD_STEPS, 2 * np.pi / _LEAST_STEPS) / omega
    period = 1e-3 if isinstance(drive.computer, str) else drive.computer.period
    is_force = diagram.outside.get(drive.drive) == "force"
    samples = np.ceil(duration / period - 1e-9)  # whole cycles, at least the number asked for
    return prepare(
        diagram,
        duration=float(samples * period),
        motion={drive.drive: motion} if prescribed else None,
        inputs=None if prescribed else {drive.drive: motion.position},
        computer=drive.computer,
        step=float(step),
        # as a share of the amplitude of the motion, of 1 mm if a force drives the diagram
        give=drive.give * (1e-3 if is_force else drive.amplitude),
    )


def _outside_signals(
    diagram: Diagram, drive: Sinusoid, rows: int, step: float
) -> dict[str, np.ndarray]:
    """Signals from outside at the nodes: the drive, and zeros."""
    inputs = {name: np.zeros(rows) for name in diagram.outside}
    if drive.drive in inputs:
        inputs[drive.drive] = sine(amplitude=drive.amplitude, frequency=drive.frequency).position(
            step * np.arange(rows)
        )
    return inputs


def _signal(diagram: Diagram, columns: Mapping[str, np.ndarray], name: str) -> np.ndarray:
    """A signal at the nodes; a sum is computed again from its terms."""
    for part in diagram.parts:
        if isinstance(part, Junction) and part.output == name:
            shape = np.zeros_like(next(iter(columns.values())))
            return sum((g * columns[s] for s, g in part.terms.items()), shape)
    return columns[name]


@dataclass(frozen=True)
class Harmonic:
    """First harmonic of a periodic signal, from the last cycles of a record.

    phasor: mean over the last two cycles, unit of the signal; sin is 1 and cos is j
    distortion: rms of all higher harmonics over that of the first; inf if the first is zero
    unsettled: largest relative difference between the last cycle and any other of the second half
        of the record; a slow transient may turn, so that two cycles alone can agree by chance
    """

    phasor: complex
    distortion: float
    unsettled: float


def phasors(cycles: np.ndarray) -> np.ndarray:
    """First harmonic of each cycle, complex, shape (...); sin(phase) is 1, cos(phase) is j.

    cycles: (..., n), one period on a uniform grid, without its end
    """
    n = cycles.shape[-1]
    angle = 2 * np.pi * np.arange(n) / n
    return np.asarray(2 * np.mean(cycles * (np.sin(angle) + 1j * np.cos(angle)), axis=-1))


def distortion(cycles: np.ndarray) -> np.ndarray:
    """Total harmonic distortion of each cycle: rms of harmonics 2, 3, ... over that of the first.

    cycles: as in `phasors`;  returns: shape (...), by Parseval from the rms of the whole
    """
    first = 0.5 * np.abs(phasors(cycles)) ** 2
    others = np.maximum(np.var(cycles, axis=-1) - first, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.sqrt(others / first))


def whole_cycles(values: np.ndarray, *, step: float, frequency: float, points: int) -> np.ndarray:
    """All whole cycles of a record that starts at t = 0, shape (cycles, points).

    values: (n,) at times 0, step, ...; linear between these, so that a cycle need not be a whole
        number of steps. Every cycle begins where sin(2 pi frequency t) rises through zero
    """
    count = int(np.floor(step * (len(values) - 1) * frequency + 1e-9))
    time = np.arange(count * points) / points / frequency
    samples = np.interp(time, step * np.arange(len(values)), values)
    return np.asarray(samples.reshape(count, points))


def lock_in(values: np.ndarray, *, step: float, frequency: float, points: int) -> Harmonic:
    """First harmonic of the last two cycles of a record that starts at t = 0.

    values: (n,), at least four cycles, at times 0, step, ... in s;  frequency: Hz
    points: of the grid over one cycle
    """
    cycles = whole_cycles(values, step=step, frequency=frequency, points=points)
    each = phasors(cycles)
    phasor = complex(each[-2:].mean())
    # 1e-12 of the record: below it a first harmonic is rounding
    size = max(abs(phasor), 1e-12 * float(np.abs(values).max()), float(np.finfo(float).tiny))
    apart = np.abs(each[len(each) // 2 - 1 :] - each[-1]).max()
    return Harmonic(phasor, float(distortion(cycles[-2:].mean(axis=0))), float(apart) / size)
