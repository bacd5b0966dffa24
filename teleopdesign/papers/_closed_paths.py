"""Couplings of several axes along closed paths, by quadrature: numbers for statement P59."""

from __future__ import annotations

import numpy as np

from ._statement import Figure, Numbers, figure_near


def turned_about(coordinates: np.ndarray) -> np.ndarray:
    """Matrix E (3, 3) of angular velocity = E rates, for body angles about x, then y, then z."""
    a, b, _ = coordinates
    x, y, z = np.eye(3)
    about_x = np.array([x, [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    about_y = np.array([[np.cos(b), 0, np.sin(b)], y, [-np.sin(b), 0, np.cos(b)]])
    return np.column_stack([x, about_x @ y, about_x @ about_y @ z])


def closed_paths() -> Numbers:
    """Energy (J) that couplings give out along closed paths, in six axes and for orientations."""
    rng, n = np.random.default_rng(59), 2000
    root = rng.normal(size=(6, 6))
    spring, skew = root @ root.T, 0.3 * (root - root.T)
    plane = np.linalg.qr(rng.normal(size=(6, 2)))[0]
    angle = 2 * np.pi * np.arange(n) / n
    circle = 0.7 * plane @ np.array([np.cos(angle), np.sin(angle)])
    rate = 0.7 * plane @ np.array([-np.sin(angle), np.cos(angle)]) * 2 * np.pi

    def released(matrix: np.ndarray) -> float:
        return float(-np.einsum("it,it->", matrix @ circle, rate) / n)

    inner = plane.T @ skew @ plane
    expected = -np.pi * 0.7**2 * (inner[1, 0] - inner[0, 1])
    size = float(np.abs(spring).max())
    # a circle in two of three angles, half a radian wide: the coupling 2 N m/rad about each
    turning = np.array([0.5 * np.cos(angle), 0.5 * np.sin(angle), 0.5 * np.cos(2 * angle)])
    rates = np.array([-np.sin(angle), np.cos(angle), -2 * np.sin(2 * angle)]) * np.pi
    plain, mapped = 0.0, 0.0
    for e, change in zip(turning.T, rates.T, strict=True):
        to_velocity = turned_about(e)
        velocity = to_velocity @ change
        plain -= float(2.0 * e @ velocity) / n
        mapped -= float(np.linalg.solve(to_velocity.T, 2.0 * e) @ velocity) / n
    return Numbers(
        (
            figure_near(
                "symmetric 6 x 6 over its size, one turn", released(spring) / size, 0, 1e-12
            ),
            figure_near("its skew part, against the formula", released(skew), expected, 1e-9, "J"),
            figure_near("angles, torques by J^T", mapped, 0.0, 1e-12, "J"),
            Figure("angles, torques as they are: size", abs(plain), low=0.01, unit="J"),
        )
    )
