"""A haptic interface of several rods that hold one hand: figure 3 with matrices as blocks.

    R_A = R_D + H (R_D - R_M) + C L        Z_M L = R_A - R_M        L = G X
    G^T R_M = -(F_H + F_V)                 F_H = -Z_H X             felt: G^T Zhat_M G

L, R are lists over the rods, X, F over the hand's coordinates, one rod for each coordinate. G is
the geometry at one pose. Everything that `haptic_interface(ANY, ...)` derives holds as it stands,
for its blocks are matrices that need not commute. Lee, Lawrence, Pao, Control Eng. Practice 12
(2004) 1423, have five such rods.

Felt friction: with motion L = G X, friction between -F_C and F_C on each rod pushes the hand with

    F = -G^T f,   f in [-F_C1, F_C1] x ... x [-F_Cn, F_Cn]

A hand that moves along a unit direction u feels h(u) = sum_k F_Ck abs(G u)_k against it: the
support function of that zonotope. It is largest towards a corner and smallest across a facet, on
which one rod alone slides.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from ..base.arguments import matrix_of
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..blocks import Body, MatrixImpedance
from ..controllers import Controller
from .junctions import Junction
from .parts import Block, Control, Linked, Moving
from .wiring import Diagram

#: controllers of single rods (None: none), or by (rod that acts, rod that is read), from 1
Controllers = Sequence[Controller | None] | Mapping[tuple[int, int], Controller]


def parallel_rods(
    rods: Sequence[Body],
    geometry: Any,
    *,
    hand: MatrixImpedance | None = None,
    mechanism: MatrixImpedance | None = None,
    cancellation: Controllers = (),
    force_feedback: Controllers = (),
    analog: Collection[str] = (),
) -> Diagram:
    """Wire rods in parallel.

    rods: n bodies, the diagonal of Z_M
    geometry: G (n, n), motion of each rod for each coordinate of the hand
    hand: Z_H (n, n) in the hand's coordinates
    mechanism: impedance that couples the rods besides the hand, added to Z_M (n, n)
    cancellation: C;  force_feedback: H
    analog: "C", "H" if no computer samples them
    Signals carry their number: R_D1, R_A1, R_M1, L1, ... of the rods; X1, F_H1, F_V1 of the hand.
    raises ModelError: G is no regular n x n matrix, or another block has another size
    """
    size = len(rods)
    inverse = _inverse(geometry, size)
    numbers = range(1, size + 1)
    blocks: list[Block] = []
    junctions: list[Junction] = []
    joined = {}
    if mechanism is not None:
        lengths, forces = _rod_names("L", numbers), _rod_names("R_Z", numbers)
        blocks.append(Linked("Z_J", mechanism, lengths, forces))
        joined = {n: {f"R_Z{n}": 1} for n in numbers}
    commands: dict[int, dict[str, float]] = {n: {f"R_D{n}": 1} for n in numbers}
    for n, rod in zip(numbers, rods, strict=True):
        loads = {f"R_M{n}": -1, **joined.get(n, {})}
        blocks.append(Moving(f"Z_M{n}", rod, f"L{n}", f"R_A{n}", loads, f"F_V{n}"))
        junctions.append(Junction(f"E{n}", {f"R_D{n}": 1, f"R_M{n}": -1}))
    laws = (("C", cancellation, "L", "R_MBC"), ("H", force_feedback, "E", "R_FF"))
    for name, controllers, read, made in laws:
        for (i, j), law in _group_by_rods(name, controllers, size).items():
            force = f"{made}{i}" if i == j else f"{made}{i}_{j}"
            of = f"{name}{i}" if i == j else f"{name}{i}_{j}"
            blocks.append(Control(of, law, f"{read}{j}", force, f"L{j}", name in analog))
            commands[i][force] = 1
    hands = {k: {f"F_V{k}": 1} for k in numbers}
    if hand is not None:
        motions, held = (_rod_names(signal, numbers) for signal in ("X", "F_H"))
        blocks.append(Linked("Z_H", hand, motions, held, role="hand"))
        hands = {k: {f"F_H{k}": 1, f"F_V{k}": 1} for k in numbers}
    for n in numbers:
        junctions.append(Junction(f"R_A{n}", commands[n]))
        junctions.append(Junction(f"X{n}", _row(inverse[n - 1], "L")))
        junctions.append(Junction(f"F{n}", hands[n]))
        junctions.append(Junction(f"R_M{n}", _row(-inverse[:, n - 1], "F")))
    return Diagram(
        f"{size} parallel rods",
        tuple(blocks),
        tuple(junctions),
        {f"{signal}{n}": "force" for n in numbers for signal in ("R_D", "F_V")},
        measured=(*_rod_names("L", numbers), *_rod_names("R_M", numbers)),
    )


def _inverse(geometry: Any, size: int) -> np.ndarray:
    """The inverse of G; raises ModelError: G is no regular matrix of that size."""
    g = matrix_of(geometry, "parallel_rods: geometry")
    if g.shape != (size, size):
        raise ModelError(f"parallel rods: geometry is {g.shape}, expected ({size}, {size})")
    if np.linalg.matrix_rank(g) < size:
        raise ModelError("parallel rods: the geometry is singular: some motion of the hand is free")
    return np.asarray(np.linalg.inv(g))


def _rod_names(signal: str, numbers: range) -> tuple[str, ...]:
    return tuple(f"{signal}{n}" for n in numbers)


def _row(weights: np.ndarray, signal: str) -> dict[str, float]:
    """Weights of numbered signals, without those that are zero."""
    return {f"{signal}{k + 1}": float(w) for k, w in enumerate(weights) if abs(w) > 1e-15}


def _group_by_rods(
    name: str, controllers: Controllers, size: int
) -> dict[tuple[int, int], Controller]:
    if isinstance(controllers, Mapping):
        by_pair = dict(controllers)
    else:
        if controllers and len(controllers) != size:
            raise ModelError(
                f"parallel rods: {name}: {len(controllers)} controllers for {size} rods"
            )
        by_pair = {(n + 1, n + 1): law for n, law in enumerate(controllers) if law is not None}
    for pair in by_pair:
        if not all(1 <= n <= size for n in pair):
            raise ModelError(f"parallel rods: {name}: no rods {pair}, numbers are 1 to {size}")
    return by_pair


_MOST_RODS = 16  # 2^15 corners


@dataclass(frozen=True, eq=False)
class FeltFriction(ByValue):
    """Friction of n rods in the n coordinates of a hand; see `felt_friction`.

    geometry: G (n, n);  levels: F_C (n,), N
    """

    geometry: np.ndarray
    levels: np.ndarray

    def along(self, directions: np.ndarray) -> np.ndarray:
        """Friction against a motion along each direction, N: the support function.

        directions: (..., n), of any length; friction is per unit of this length
        """
        return np.asarray(np.abs(directions @ self.geometry.T) @ self.levels)

    def force(self, directions: np.ndarray) -> np.ndarray:
        """Force of friction on a hand that moves along each direction (..., n), N: minus a corner.

        Rods that do not move in this motion contribute nothing.
        """
        sliding = np.sign(directions @ self.geometry.T)
        return np.asarray(-(sliding * self.levels) @ self.geometry)

    def holds(self, forces: np.ndarray, *, tolerance: float = 1e-9) -> np.ndarray:
        """Whether friction can balance each of these forces on the hand (..., n), N.

        tolerance: of each rod's level, relative;  returns: (...,)
        """
        rods = forces @ np.linalg.inv(self.geometry)
        return np.asarray((np.abs(rods) <= (1 + tolerance) * self.levels).all(axis=-1))

    @property
    def largest(self) -> tuple[float, np.ndarray]:
        """Level (N) and unit direction (n,) of the largest friction: the farthest corner."""
        n = len(self.levels)
        signs = np.array([(1.0, *rest) for rest in product((-1.0, 1.0), repeat=n - 1)])
        corners = (signs * self.levels) @ self.geometry
        sizes = np.linalg.norm(corners, axis=1)
        farthest = int(np.argmax(sizes))
        size = float(sizes[farthest])
        return size, corners[farthest] / (size or 1.0)

    @property
    def smallest(self) -> tuple[float, np.ndarray]:
        """Level (N) and unit direction (n,) of the smallest friction: across the nearest facet."""
        alone = np.linalg.inv(self.geometry).T  # row k: the motion of the hand that moves rod k
        lengths = np.linalg.norm(alone, axis=1)
        nearest = int(np.argmin(self.levels / lengths))
        return float(self.levels[nearest] / lengths[nearest]), alone[nearest] / lengths[nearest]

    def __repr__(self) -> str:
        (most, _), (least, _) = self.largest, self.smallest
        return f"Friction of {len(self.levels)} rods: {least:.4g} to {most:.4g} N at the hand"


def felt_friction(geometry: np.ndarray, levels: Sequence[float]) -> FeltFriction:
    """Friction that a hand feels from parallel rods.

    geometry: G (n, n), as for `parallel_rods`
    levels: Coulomb level of each rod, or the part that a cancellation leaves, N
    raises ModelError: G is no regular n x n matrix, a level is negative, more than 16 rods
    """
    g, f = np.asarray(geometry, dtype=float), np.asarray(levels, dtype=float)
    if f.ndim != 1 or g.shape != (len(f), len(f)) or not 1 <= len(f) <= _MOST_RODS:
        raise ModelError(
            f"felt_friction: geometry is {g.shape} and levels {f.shape}, expected (n, n) and (n,) "
            f"with n up to {_MOST_RODS}"
        )
    if np.linalg.matrix_rank(g) < len(f):
        raise ModelError("felt_friction: the geometry is singular: some motion of the hand is free")
    if not (f >= 0).all():
        raise ModelError(f"felt_friction: levels must not be negative, found {f.min():g} N")
    return FeltFriction(g, f)
