"""Search a diagram for a motion over which a port releases energy, from rest back to rest.

The motion of the port is prescribed, and the compiled kernel simulates the force for this motion.
The released energy is minus the integral of force times velocity. A motion that releases energy
refutes passivity; a search without result proves nothing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from ...base.errors import ModelError
from ...base.units import unit_of
from ...diagrams import Diagram
from ...diagrams.units import first_axis
from ...simulate import Sampling, simulate
from ..claims.claim import Claim, Evidence, Refutation, Unknown
from ..linear.impedance import decimal, exact
from .stroke_motion import Strokes, families

Computer = Sampling | Literal["continuous"]
#: steps in the shortest stroke; fewer where one simulation would then have more than _MOST steps
_FINE, _MOST = 100, 40_000
_LONGEST = 2_000_000  # most steps of one simulation
#: most rounds of a motion, repeated until it has released the energy that its start took
_ROUNDS = 300


@dataclass(frozen=True)
class Given:
    """Energies that the port released in one simulation, J.

    total: from rest back to rest;  last_round: over the last closed round
    turned: integral of abs(force times velocity), the scale of both
    """

    total: float
    last_round: float
    turned: float


@dataclass(frozen=True)
class SimulatedMotion:
    """A motion of a port that releases energy; `replay()` simulates this motion anew.

    port: (motion, force ON the device along this motion);  strokes: the motion
    computer: as in `simulate`;  give: m or rad, as in `simulate`
    energy: released, J, from rest back to rest
    """

    diagram: Diagram = field(repr=False)
    port: tuple[str, str]
    strokes: Strokes
    computer: Computer
    give: float
    energy: float

    def replay(self) -> float:
        """Energy released, J, from rest back to rest, simulated anew."""
        return released_energy(
            self.diagram, self.strokes, port=self.port, computer=self.computer, give=self.give
        ).total

    def as_dict(self) -> dict[str, object]:
        """Plain data, to be written as JSON; the diagram by its wiring and its values."""
        sampling = self.computer if isinstance(self.computer, str) else vars(self.computer)
        return {
            "kind": "simulated motion",
            "diagram": repr(self.diagram),
            "values": dict(self.diagram.values),
            "port": list(self.port),
            "turning_points": list(self.strokes.points),
            "speed": self.strokes.speed,
            "rounds": self.strokes.rounds,
            "pause": self.strokes.pause,
            "computer": sampling,
            "give": self.give,
            "energy": self.energy,
        }


def released_energy(
    diagram: Diagram,
    strokes: Strokes,
    *,
    port: tuple[str, str] = ("L", "R_V"),
    computer: Computer = "continuous",
    give: float = 1e-7,
    finer: int = 1,
) -> Given:
    """Energy that the port releases along these strokes; hidden states start at zero.

    port: (motion, force ON the device along it);  computer, give: as in `simulate`
    finer: the step of the simulation is divided by this factor
    raises ModelError: the motion of the port cannot be prescribed, or the motion is too long
    """
    shortest = float(np.diff(strokes.times).min())
    period = 1e-3 if isinstance(computer, str) else computer.period
    duration = np.ceil(strokes.duration / period) * period
    step = min(max(min(shortest / _FINE, 1e-4), duration / _MOST), period) / finer
    if duration / step > _LONGEST:
        raise ModelError(
            f"released_energy: {duration / step:.3g} steps of simulation, at most {_LONGEST:g}: "
            "ask for fewer rounds or more speed"
        )
    motion, force = port
    simulation = simulate(
        diagram,
        duration=duration,
        motion={motion: strokes.motion()},
        computer=computer,
        step=step,
        give=give,
        every_step=True,
    )
    t, power = (
        simulation.data["time"].values,
        -simulation[force].values * simulation[f"{motion}_velocity"].values,
    )
    parts = np.diff(t) * (power[1:] + power[:-1]) / 2
    begin, end = strokes.last_round
    middle = (t[1:] + t[:-1]) / 2
    return Given(
        float(parts.sum()),
        float(parts[(middle > begin) & (middle < end)].sum()),
        float(np.abs(parts).sum()),
    )


def confirmed_motion(
    diagram: Diagram,
    strokes: Strokes,
    *,
    port: tuple[str, str] = ("L", "R_V"),
    computer: Computer = "continuous",
    give: float = 1e-7,
) -> SimulatedMotion | None:
    """These strokes, repeated as needed, if they release more energy than the numerical error.

    The motion begins and ends at rest, with hidden states at zero at the start. So no stored energy
    can have paid for the release. The energy must also come out with half the step, and with a
    tenth of `give`, and must be more than three times the change between these simulations.

    port, computer, give: as in `released_energy`
    returns: None where the strokes release no energy, or not certainly
    """

    def run(strokes: Strokes, *, finer: int = 1, give: float = give) -> Given:
        return released_energy(
            diagram, strokes, port=port, computer=computer, give=give, finer=finer
        )

    first = run(strokes)
    if first.last_round <= 0:
        return None
    lacking = max(first.last_round - first.total, 0.0)
    rounds = strokes.rounds + int(min(2 * lacking / first.last_round, _ROUNDS + 1))
    if rounds > _ROUNDS:
        return None
    strokes = replace(strokes, rounds=rounds)
    try:
        whole, finer = run(strokes), run(strokes, finer=2)
        firmer = run(strokes, finer=2, give=give / 10)
    except ModelError:  # too long, or the firmer contact too stiff to resolve: not confirmed
        return None
    doubt = 3 * max(abs(whole.total - finer.total), abs(finer.total - firmer.total))
    if min(whole.total, finer.total, firmer.total) <= max(doubt, 1e-9 * whole.turned):
        return None
    return SimulatedMotion(diagram, port, strokes, computer, give, whole.total)


def search_counterexample(
    diagram: Diagram,
    *,
    stroke: float,
    speed: float,
    rng: np.random.Generator | int = 0,
    port: tuple[str, str] = ("L", "R_V"),
    computer: Computer = "continuous",
    give: float = 1e-7,
    tries: int = 60,
) -> Claim:
    """Does any motion within stroke and speed, from rest back to its start, take energy out?

    stroke: largest position, m or rad;  speed: largest speed, m/s or rad/s
    port, computer: as in `released_energy`;  tries: number of motions
    rng: draws the motions, or the seed of the generator that does
    give: m or rad, of ideal Coulomb friction. The shortest motions are a thousandth of `stroke`:
        choose it far below this, and below any bristle length
    returns: refuted by a motion that was confirmed with half the step and a tenth of `give`;
        else evidence, which is no proof. Unknown where simulated forces are not finite
    raises ModelError: stroke or speed is not > 0, or the motion of the port cannot be prescribed
    """
    if stroke <= 0 or speed <= 0:
        raise ModelError(
            f"search_counterexample: expected stroke and speed > 0, found {stroke}, {speed}"
        )
    rng = np.random.default_rng(rng)
    length, rate = (unit_of(q, first_axis(diagram)) for q in ("position", "velocity"))
    statement = (
        f"the port {port[0]}, {port[1]} of the {diagram.name} releases no energy over any motion "
        f"that returns, within {decimal(exact(stroke))} {length} and {decimal(exact(speed))} {rate}"
    )

    def score(strokes: Strokes) -> float:
        one = released_energy(diagram, strokes, port=port, computer=computer, give=give)
        return one.last_round / one.turned if one.turned else 0.0

    motions = [
        (score(s), name, s) for name, s in families(rng, stroke=stroke, speed=speed, tries=tries)
    ]
    for _, name, strokes in sorted(motions, key=lambda one: -one[0])[:3]:
        better = _refine(strokes, score, stroke=stroke, speed=speed)
        confirmed = confirmed_motion(diagram, better, port=port, computer=computer, give=give)
        if confirmed is not None:
            return Claim(statement, Refutation(f"a motion of the search, {name}", confirmed))
    best = max(s for s, _, _ in motions)
    if not np.isfinite([s for s, _, _ in motions]).all():
        return Claim(statement, Unknown("the simulated forces are not finite"))
    searched = (
        f"{len(motions)} motions (sinusoids, stops and reversals, random paths), none releases "
        "energy; a search is no proof"
    )
    return Claim(statement, Evidence(True, searched, -best, "of the energy turned over"))


def _refine(
    strokes: Strokes, score: Callable[[Strokes], float], *, stroke: float, speed: float
) -> Strokes:
    """The strokes with size and speed changed so that they release a larger share of the energy."""
    from scipy.optimize import minimize

    largest = max(abs(x) for x in strokes.points)

    def at(x: np.ndarray) -> Strokes:
        size = min(float(np.exp(x[0])), stroke / largest)
        faster = min(float(np.exp(x[1])) * strokes.speed, speed)
        return replace(strokes, points=tuple(size * p for p in strokes.points), speed=faster)

    def lacking(x: np.ndarray) -> float:
        return -score(at(x))

    minimum = minimize(lacking, np.zeros(2), method="Nelder-Mead", options={"maxfev": 20})
    return at(minimum.x)
