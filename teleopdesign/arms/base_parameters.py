"""Base parameters: the combinations of inertial parameters that motions of an arm determine.

Many of the ten parameters of a link act only together with those of other links, and some not at
all: a mass on an axis that never tilts causes no torque. The kinematics alone decide which columns
of the regressor are independent. So these are selected at random poses, by orthogonalisation:
moments first, then masses, motors last. Each base parameter has the name of the inertial parameter
whose column is selected.

Source: Gautier, Khalil, Direct calculation of minimum set of inertial parameters of serial robots,
IEEE Trans. Robotics and Automation 6 (1990) 368.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..base.frozen import ByValue
from .chain import INERTIAL, UNITS, Array, Chain
from .regressor import force_columns

#: random poses per joint: a few times the number of inertial parameters
POSES = 60
#: the rest of a column after elimination, relative to the largest column, below which it is
#: rounding: dependent columns leave 1e-13, independent ones 1e-4 and more
INDEPENDENT = 1e-8


@dataclass(frozen=True, eq=False)
class BaseParameters(ByValue):
    """Combinations of an arm's inertial parameters and motor inertias that its motion determines.

    names: of the b base parameters, such as "forearm_link.mx";  units: of each
    chosen: (b,) their columns in the regressor;  initial: (b,) their values by those of the arm
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    chosen: NDArray[np.intp]
    initial: Array


def columns_with_motors(arm: Chain, position: Array, velocity: Array, acceleration: Array) -> Array:
    """Regressor of the joint forces by inertial parameters and motor inertias (k, 11 k, n).

    position, velocity, acceleration: (k, n)
    The rotor of a joint needs its inertia times the acceleration of this joint, at this joint.
    """
    columns = force_columns(arm, position, velocity, acceleration)
    motors = np.eye(len(arm.links))[:, :, None] * acceleration[:, None, :]
    return np.concatenate([columns, motors], axis=1)


def base_parameters(arm: Chain, *, seed: int = 0) -> BaseParameters:
    """The base parameters of an arm, with moments preferred to masses, and masses to motors.

    seed: of the random poses; the parameters depend on it by rounding only
    """
    k, generator = len(arm.links), np.random.default_rng(seed)
    q, v, a = (generator.uniform(-np.pi, np.pi, (k, POSES * k)) for _ in range(3))
    columns = columns_with_motors(arm, q, v, a)
    rows = columns.transpose(0, 2, 1).reshape(-1, columns.shape[1])
    order = np.argsort([_turn(i, k) for i in range(rows.shape[1])], kind="stable")
    chosen = np.sort(order[_independent(rows[:, order])])
    names = [f"{link.name}.{x}" for link in arm.links for x in INERTIAL]
    names += [f"{link.joint}.motor_inertia" for link in arm.links]
    motor = ["kg" if link.kind == "prismatic" else "kg*m^2" for link in arm.links]
    units = [*UNITS * k, *motor]
    whole = np.concatenate([arm.inertial, np.zeros(k)])
    initial = np.linalg.lstsq(rows[:, chosen], rows @ whole, rcond=None)[0]
    return BaseParameters(
        tuple(names[i] for i in chosen), tuple(units[i] for i in chosen), chosen, initial
    )


def _turn(column: int, links: int) -> int:
    """Rank of a column in the selection: moments of links 0, masses 1, motors 2."""
    if column >= len(INERTIAL) * links:
        return 2
    return 1 if column % len(INERTIAL) == 0 else 0


def _independent(rows: Array) -> NDArray[np.intp]:
    """Indices of the columns that do not depend on the columns before them, in their order."""
    size = np.linalg.norm(rows, axis=0)
    basis = np.zeros((len(rows), 0))
    chosen = []
    for i in np.flatnonzero(size > INDEPENDENT * size.max()):
        left = rows[:, i] / size[i]
        for _ in range(2):  # twice: what rounding leaves of the first is taken out too
            left = left - basis @ (basis.T @ left)
        length = float(np.linalg.norm(left))
        if length > INDEPENDENT:
            basis = np.hstack([basis, left[:, None] / length])
            chosen.append(int(i))
    return np.array(chosen, dtype=np.intp)
