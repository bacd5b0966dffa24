"""The loop of a controller that samples and holds: exact, as a system in discrete time.

    x' = A x + sum_k B_k u(t - T_k),   y = C x + sum_k D_k u(t - T_k),   u held over each sample h

With a dead time T = m h + d, 0 <= d < h, the input is the value held m + 1 samples before in the
first part d of each sample, and the value held m samples before in the rest (Astrom and Wittenmark,
Computer-Controlled Systems, 3.2). A sample is read just before the output changes, so that the part
D of the response is delayed by one sample. So y = P(z) u with

    P(z) = sum_k z^-m_k (C (z I - e^(A h))^-1 (B0_k + B1_k/z) + D_k/z)

The characteristic polynomial decides, in fifty digits, whether the closed loop grows. Values on the
unit circle are computed in floats as functions of z - 1, since slow poles lie close to z = 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, reduce

import mpmath
import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..controllers import (
    Controller,
    controller,
    exact_decimal,
    is_of_matrices,
    matrices_of,
    sides_of,
    unseen_factor,
)
from ..derive.all_states import all_states
from ..derive.polynomials import fraction, is_free_of_growth
from ..diagrams import Control, Diagram
from ..realise.lti import LinearBlocks
from .held_plant import HeldPlant, as_mpf
from .late_loop import LateRatio
from .late_zeros import describe_growth, exact_terms

#: rational numbers, highest power first
Coefficients = tuple[Fraction, ...]
_DIGITS = 50
#: distance of a root from the unit circle, relative to its size, within which it counts as growing
_NEAR = 1e-20
#: most samples of dead time in all: the polynomial has as many powers
MOST_SAMPLES = 1000


@dataclass(frozen=True)
class SampledLoop:
    """A loop in discrete time; stable feedback is > 0, as in `LoopGain`: u = -(law) y.

    period: h, s;  law: numerator and denominator in z
    below: denominator of the path from u to y, in s;  above: dead time (s) -> its numerators
    fault: a mode that grows and that the loop does not see, in words; "" for none
    """

    period: Fraction
    law: tuple[Coefficients, Coefficients]
    below: Coefficients
    above: tuple[tuple[Fraction, Coefficients], ...]
    fault: str = ""

    def with_delay(self, time: float) -> SampledLoop:
        """The loop with an additional dead time (s)."""
        more = Fraction(time)
        return replace(self, above=tuple((t + more, p) for t, p in self.above))

    @property
    def samples(self) -> int:
        """Whole samples in the longest dead time of the loop."""
        return max((int(t // self.period) for t, _ in self.above), default=0)

    def corners(self) -> np.ndarray:
        """Angles w h at which poles and zeros turn the phase, and points across resonances."""
        numerators = {float(t): _floats(p) for t, p in self.above}
        slow = LateRatio(numerators, {0.0: _floats(self.below)}).corners() * float(self.period)
        roots = np.concatenate([np.roots(_about_one(p)) + 1 for p in self.law])
        roots = roots[np.abs(roots) > 0]
        near = np.maximum(np.abs(np.log(np.abs(roots)))[:, None], 1e-9)
        across = np.abs(np.angle(roots))[:, None] + near * np.linspace(-3, 3, 25)
        angles = np.concatenate([slow, across.ravel()])
        return np.asarray(np.unique(angles[(angles > 0) & (angles < np.pi)]))

    def grows(self) -> bool:
        """Whether the closed loop has a mode that does not decay.

        raises ModelError: dead times of more than `MOST_SAMPLES`
        """
        if self.samples > MOST_SAMPLES:
            raise ModelError(
                f"loop: a dead time of {self.samples} samples, expected at most {MOST_SAMPLES}"
            )
        with mpmath.workdps(_DIGITS):
            return not _decays(self._characteristic())

    def _characteristic(self) -> np.ndarray:
        """Characteristic polynomial of the closed loop in z, highest first, `_DIGITS` digits."""
        plant = HeldPlant.of(self.period, self.below, self.above)
        below, shares = plant.polynomials()
        most = max((m for m, *_ in shares), default=0) + 1
        above = np.zeros(1)
        for m, now, before in shares:
            # (z now + before) z^(most - 1 - m)
            both = np.polyadd([*now, 0], before)
            above = np.polyadd(above, [*both, *[0] * (most - 1 - m)])
        over, under = (np.array([as_mpf(c) for c in side]) for side in self.law)
        return np.polyadd(np.convolve(under, [*below, *[0] * most]), np.convolve(over, above))

    @cached_property
    def _floats(self) -> tuple[np.ndarray, ...]:
        """Matrices of states and inputs over one sample in floats; e^(A h) - I is kept small."""
        with mpmath.workdps(_DIGITS):
            return HeldPlant.of(self.period, self.below, self.above).as_floats()

    def __call__(self, angle: np.ndarray) -> np.ndarray:
        """Loop gain at z = e^(j angle), (n,)."""
        step, now, before, straight, whole, c = self._floats
        less = np.expm1(1j * np.asarray(angle, dtype=float))  # z - 1
        z = 1 + less
        total = np.zeros(len(z), dtype=complex)
        n = len(step)
        late = z[:, None] ** -whole
        inputs = (late @ now.T) + (late / z[:, None]) @ before.T
        if n:
            matrices = less[:, None, None] * np.eye(n) - step
            total += np.linalg.solve(matrices, inputs[:, :, None])[:, :, 0] @ c
        total += (late / z[:, None]) @ straight
        law = [np.polyval(_about_one(side), less) for side in self.law]
        return np.asarray(total * law[0] / law[1])


def sampled_loop(diagram: Diagram, part: Control, linear: LinearBlocks) -> SampledLoop | None:
    """The loop opened at a controller that samples and holds, with everything else linear.

    None if the loop has another form: another controller samples too, laws in continuous time stand
    beside the discrete one in the controller, or a dead time lies within another loop.

    diagram: bodies with a structure apart;  linear: its blocks
    """
    law = part.controller
    if linear.held != (part.name,) or not isinstance(law, Controller):
        return None
    if any(stage.law.in_z is None or not is_of_matrices(stage.law) for stage in law.stages):
        return None  # only matrices say how many states there are
    periods = {exact_decimal(stage.values["period"]) for stage in law.stages}
    if len(periods) != 1 or 0 in periods:
        return None
    above, below, fault = _sides_in_z(part)
    opened = diagram.open_at(part.name)
    if part.input not in opened.signals:
        return None
    law_in_z = _rationals(above), _rationals(below)
    made = _loop_round(opened, part, linear.speed, fraction(periods.pop()), law_in_z)
    return replace(made, fault=fault) if made is not None and fault else made


def unseen_beside(diagram: Diagram, away: Sequence[Control]) -> str:
    """Modes that grow whatever these laws are, or that one of them hides, in words; "" for none.

    Gains stand in the place of the laws. What all powers of a common factor of these gains share
    is a mode that none of them changes.
    """
    factor, names = sp.Symbol("factor"), {part.name for part in away}
    gains = {
        part.name: replace(
            part, controller=controller("gain", {"gain": float(sp.prime(5 + k))}), entry=None
        )
        for k, part in enumerate(away)
    }
    at_gains = replace(diagram, blocks=tuple(gains.get(b.name, b) for b in diagram.blocks))
    states = all_states(at_gains, gains=dict.fromkeys(names, factor))
    place, whole = states.ring.symbols.index(factor), states.determinant()
    sides = (
        states.ring({k: c for k, c in whole.items() if k[place] == power})
        for power in {k[place] for k in whole}
    )
    unseen = reduce(lambda a, b: a.gcd(b), sides, states.ring.zero)
    if unseen and (modes := describe_growth(unseen, states.times)):
        return f"a mode that it does not see grows: {modes}"
    systems: dict[str, list[Control]] = {}
    for part in away:
        systems.setdefault(part.entry.of if part.entry else part.name, []).append(part)
    return next(filter(None, map(_unseen_in_samples, systems.values())), "")


def _unseen_in_samples(parts: Sequence[Control]) -> str:
    """Modes of a law in discrete time that it does not show and that grow, in words; or "".

    parts: the law, or all entries of a system of several inputs and outputs
    """
    laws = [stage.law for part in parts for stage in part.stages]
    if not laws or not all(law.in_z is not None and is_of_matrices(law) for law in laws):
        return ""
    known = [made for part in parts if (made := matrices_of(part.controller)) is not None]
    if len(parts) == 1 or len(known) < len(parts):
        return _sides_in_z(parts[0])[2]
    columns, rows = (np.array([made[k] for made in known]) for k in (1, 2))
    return _describe_unseen(unseen_factor(known[0][0], columns.T, rows, sp.Symbol("z")))


def _sides_in_z(part: Control) -> tuple[sp.Poly, sp.Poly, str]:
    """Coprime sides of a law of matrices in z, and the modes that cancel and grow, in words."""
    z = sp.Symbol("z")
    sides = [sides_of(stage.values, z) for stage in part.stages]
    above, below = (reduce(sp.Poly.mul, side) for side in zip(*sides, strict=True))
    unseen = sp.gcd(above, below)
    return above.quo(unseen), below.quo(unseen), _describe_unseen(unseen)


def _describe_unseen(unseen: sp.Poly) -> str:
    modes = ", ".join(f"z = {r:.4g}" for r in np.roots(_floats(_rationals(unseen))))
    grows = not is_free_of_growth(_reverse(unseen))
    return f"a mode that it does not see grows, among {modes}" if grows else ""


def _reverse(p: sp.Poly) -> sp.Poly:
    """A polynomial in z as one in w, z = (1 + w)/(1 - w): its roots outside the circle grow."""
    n, w = p.degree(), sp.Poly(p.gen, p.gen, domain="QQ")
    terms = (((1 + w) ** k * (1 - w) ** (n - k)).mul_ground(c) for (k,), c in p.terms())
    return reduce(sp.Poly.add, terms)


def _loop_round(
    opened: Diagram,
    part: Control,
    speed: float,
    period: Fraction,
    law: tuple[Coefficients, Coefficients],
) -> SampledLoop | None:
    """The loop of this law; None: its path is improper, or has a dead time in another loop."""
    states = all_states(opened, speed=speed)
    below, ((above,),) = states.solve([part.input], [part.output])
    unseen, above, below = (-above).cofactors(below)
    if any(any(k[1:]) for k in below) or max((k[0] for k in above), default=0) > below.degree():
        return None
    numerators = tuple((t, tuple(p)) for t, p in exact_terms(above, states.times).items())
    ((_, plain),) = exact_terms(below, states.times).items()
    modes = describe_growth(unseen, states.times)
    fault = f"a mode that it does not see grows: {modes}" if modes else ""
    return SampledLoop(period, law, tuple(plain), numerators, fault)


def _rationals(polynomial: sp.Poly) -> Coefficients:
    return tuple(map(fraction, polynomial.all_coeffs()))


def _decays(polynomial: np.ndarray) -> bool:
    """Whether all roots are inside the unit circle (Schur, Cohn, Jury)."""
    p = list(polynomial)
    while p and p[0] == 0:
        p = p[1:]
    while len(p) > 1:
        lead, last = p[0], p[-1]
        if abs(last) >= abs(lead) * (1 - _NEAR):
            return False
        share = last / lead
        p = [a - share * b for a, b in zip(p[:-1], p[:0:-1], strict=True)]
    return bool(p)


def _about_one(coefficients: Coefficients) -> np.ndarray:
    """Coefficients in z - 1 of a polynomial in z, exact until the last step."""
    left, made = list(coefficients), []
    for _ in coefficients:  # Horner's scheme, again and again
        for i in range(1, len(left)):
            left[i] += left[i - 1]
        made.append(left.pop())
    return np.array([float(c) for c in reversed(made)])


def _floats(coefficients: Coefficients) -> np.ndarray:
    return np.array([float(c) for c in coefficients])
