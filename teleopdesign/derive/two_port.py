"""The teleoperator as a two-port, from the wiring: impedance and hybrid matrix, transparency.

    F_m = Z_mm X_m + Z_ms X_s          F_m = h_11 X_m + h_12 F_s
    F_s = Z_sm X_m + Z_ss X_s          X_s = h_21 X_m + h_22 F_s

Forces of hand and environment act on master and slave; impedances are relative to position. Two-
ports are by positions, as in the papers, or by velocities, as in the hybrid matrix of Hannaford:

    position:   F_m = h_11 X_m + h_12 F_s          velocity:   F_m = h_11 v_m + h_12 F_e
                X_s = h_21 X_m + h_22 F_s                      -v_s = h_21 v_m + h_22 F_e

F_s is what the environment does to the slave, F_e = -F_s what the slave does to it. Velocities of
both sides point the same way. So, exactly and with no approximation,

    velocity h_11 = h_11/s    h_12 = -h_12    h_21 = -h_21    h_22 = s h_22    Z_ij = Z_ij/s

By positions h_11 is in N/m, h_22 in m/N and Z in N/m; by velocities in N s/m, m/(N s) and N s/m
(revolute axes: N m and rad in the place of N and m); h_12 and h_21 are numbers. A teleoperator that
nobody notices has h_12 = -1, h_21 = 1 by positions, h_12 = 1, h_21 = -1 by velocities, and h_11 =
h_22 = 0: the hand holds against what the environment does.

Hannaford, IEEE Trans. Robotics Autom. 5 (1989) 426.
"""

from __future__ import annotations

from typing import Literal, get_args

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError, did_you_mean
from ..base.frozen import Frozen
from ..diagrams import Attached, Diagram
from ..diagrams.parts import PortRole
from ..realise.lti import S
from .printing import block_symbol
from .transfer_functions import Case, TransferFunctions

Convention = Literal["position", "velocity"]
#: function -> sign and power of s that take it from positions to velocities
_TO_VELOCITY = {
    **{f"Z_{i}{j}": (1, -1) for i in "ms" for j in "ms"},
    "h_11": (1, -1),
    "h_12": (-1, 0),
    "h_21": (-1, 0),
    "h_22": (1, 1),
    "Z_t": (1, -1),
    "Z_t - Z_E": (1, -1),
}
VELOCITY_TEXTS = {
    "Z_mm": "v_m to F_m, slave held",
    "Z_ms": "v_s to F_m, master held",
    "Z_sm": "v_m to F_s, slave held",
    "Z_ss": "v_s to F_s, master held",
    "h_11": "v_m to F_m, slave free: impedance felt in free space",
    "h_12": "F_e to F_m, master held: force transmission",
    "h_21": "v_m to -v_s, slave free: velocity tracking",
    "h_22": "F_e to -v_s, master held: admittance of the slave",
    "Z_t": "v_m to F_m in contact: transmitted impedance",
    "Z_t - Z_E": "transparency error",
}


def check_convention(convention: str) -> None:
    """Raise ModelError, with the nearest name, for a text that is no convention."""
    known = get_args(Convention)
    if convention not in known:
        near = did_you_mean(convention, known)
        raise ModelError(f'convention: no "{convention}", has {", ".join(known)}{near}')


def convert_convention(name: str, expression: sp.Expr, convention: Convention) -> sp.Expr:
    """Convert a function of a two-port from the other convention into `convention`, exactly.

    name: "Z_mm", "h_11", ..., "Z_t";  expression: in `s`, of blocks or numbers
    raises ModelError: no such function or convention
    """
    check_convention(convention)
    if name not in _TO_VELOCITY:
        raise ModelError(
            f'convention: no function "{name}", has {", ".join(_TO_VELOCITY)}'
            f"{did_you_mean(name, _TO_VELOCITY)}"
        )
    sign, power = _TO_VELOCITY[name]
    return sign * S ** (power if convention == "velocity" else -power) * expression


def hybrid_from_impedance(z: sp.Matrix, *, convention: Convention) -> sp.Matrix:
    """Hybrid matrix [[h_11, h_12], [h_21, h_22]] from impedances [[Z_mm, Z_ms], [Z_sm, Z_ss]].

    convention: of both matrices
    raises ModelError: no such convention, or Z_ss = 0: no force determines the motion of the slave
    """
    check_convention(convention)
    _check_shape(z)
    if z[1, 1] == 0:
        raise ModelError("hybrid_from_impedance: Z_ss is 0: no force determines the slave's motion")
    return _second_port_turned(z, convention)


def impedance_from_hybrid(h: sp.Matrix, *, convention: Convention) -> sp.Matrix:
    """Impedances [[Z_mm, Z_ms], [Z_sm, Z_ss]] from the hybrid matrix [[h_11, h_12], [h_21, h_22]].

    convention: of both matrices
    raises ModelError: no such convention, or h_22 = 0: no force moves the slave
    """
    check_convention(convention)
    _check_shape(h)
    if h[1, 1] == 0:
        raise ModelError("impedance_from_hybrid: h_22 is 0: no force moves the slave")
    return _second_port_turned(h, convention)


def _second_port_turned(m: sp.Matrix, convention: Convention) -> sp.Matrix:
    """The matrix with force and motion of port 2 exchanged; the same rule in both directions.

    With several axes the entries do not commute: the inverse acts first on what acts on port 2.
    """
    sign = -1 if convention == "velocity" else 1
    inverse = sp.Pow(m[1, 1], -1)
    through, back = m[0, 1] * inverse, inverse * m[1, 0]
    return sp.Matrix([[m[0, 0] - m[0, 1] * back, sign * through], [-sign * back, inverse]])


def _check_shape(matrix: sp.Matrix) -> None:
    if matrix.shape != (2, 2):
        raise ModelError(f"two-port: expected a 2x2 matrix, found {matrix.rows}x{matrix.cols}")


_SIGNALS = ("X_m", "X_s", "F_m", "F_s")
_TEXTS = {
    "Z_mm": "X_m to F_m, slave held",
    "Z_ms": "X_s to F_m, master held",
    "Z_sm": "X_m to F_s, slave held",
    "Z_ss": "X_s to F_s, master held",
    "h_11": "X_m to F_m, slave free: impedance felt in free space",
    "h_12": "F_s to F_m, master held: force transmission",
    "h_21": "X_m to X_s, slave free: position tracking",
    "h_22": "F_s to X_s, master held: admittance of the slave",
    "Z_t": "X_m to F_m in contact: transmitted impedance",
    "Z_t - Z_E": "transparency error",
}


def has_two_sides(diagram: Diagram) -> bool:
    """Whether the diagram has the motions, forces and outside forces of a teleoperator."""
    outside = {"F_u", "F_d"} <= set(diagram.outside)
    return outside and set(_SIGNALS) <= set(diagram.signals)


def two_port_cases(diagram: Diagram) -> dict[str, Case]:
    """The case of each function of a teleoperator, without the transparency error.

    raises ModelError: the diagram lacks X_m, F_m of a master or X_s, F_s of a slave
    """
    for name in _SIGNALS:
        if name not in diagram.signals:
            raise ModelError(f'{diagram.name}: no teleoperator: it has no signal "{name}"')
    hands, environments = (_find_roles(diagram, role) for role in ("hand", "environment"))
    ports = diagram.without(*hands, *environments)
    both = ("X_m", "X_s")
    of: dict[str, tuple[str, str, tuple[str, ...]]]
    of = {f"Z_{i}{j}": (f"F_{i}", f"X_{j}", both) for i in "ms" for j in "ms"}
    for row, output in ((1, "F_m"), (2, "X_s")):
        of |= {f"h_{row}1": (output, "X_m", ("X_m",)), f"h_{row}2": (output, "F_d", ("X_m",))}
    cases = {n: Case(ports, *case, _TEXTS[n]) for n, case in of.items()}
    if environments:
        touched = diagram.without(*hands)
        cases["Z_t"] = Case(touched, "F_m", "X_m", ("X_m",), _TEXTS["Z_t"])
    return cases


def _find_roles(diagram: Diagram, role: PortRole) -> list[str]:
    """Names of the blocks of that role at the master or at the slave."""
    resisting = (b for b in diagram.blocks if isinstance(b, Attached))
    return [b.name for b in resisting if b.role == role and b.motion in ("X_m", "X_s")]


@check_types
def two_port_functions(
    diagram: Diagram, *, convention: Convention = "position"
) -> TransferFunctions:
    """Every function of a teleoperator; Z_t and Z_t - Z_E only with an environment at the slave.

    convention: "position", or "velocity" as in Hannaford's hybrid matrix, see `conventions`
    raises ModelError: the diagram lacks X_m, F_m of a master or X_s, F_s of a slave; no convention
    """
    check_convention(convention)
    expressions = {name: case.derive() for name, case in two_port_cases(diagram).items()}
    if "Z_t" in expressions:
        touched = sum((block_symbol(n) for n in _find_roles(diagram, "environment")), sp.S(0))
        expressions["Z_t - Z_E"] = expressions["Z_t"] - touched
    texts = {name: _TEXTS[name] for name in expressions}
    if convention == "velocity":
        expressions = {n: convert_convention(n, e, convention) for n, e in expressions.items()}
        texts = {name: VELOCITY_TEXTS[name] for name in expressions}
    return TransferFunctions(diagram, Frozen(expressions), Frozen(texts))
