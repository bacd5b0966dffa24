"""The teleoperator as a two-port, from the wiring: impedance and hybrid matrix, transparency.

    F_m = Z_mm X_m + Z_ms X_s          F_m = h_11 X_m + h_12 F_s
    F_s = Z_sm X_m + Z_ss X_s          X_s = h_21 X_m + h_22 F_s

Forces of hand and environment act on master and slave; impedances are relative to position. A
teleoperator that nobody notices has h_11 = h_22 = 0, h_21 = I, h_12 = -I: the hand holds against
what the environment does. Hannaford, IEEE Trans. Robotics Autom. 5 (1989) 426, with positions in
the place of velocities and the force on the slave in the place of its reaction.
"""

from __future__ import annotations

import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import Frozen
from ..diagrams import Attached, Diagram
from ..diagrams.parts import PortRole
from .conventions import VELOCITY_TEXTS, Convention, check_convention, convert_convention
from .printing import block_symbol
from .transfer_functions import Case, TransferFunctions

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
    hands, environments = (_held(diagram, role) for role in ("hand", "environment"))
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


def _held(diagram: Diagram, role: PortRole) -> list[str]:
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
        touched = sum((block_symbol(n) for n in _held(diagram, "environment")), sp.S(0))
        expressions["Z_t - Z_E"] = expressions["Z_t"] - touched
    texts = {name: _TEXTS[name] for name in expressions}
    if convention == "velocity":
        expressions = {n: convert_convention(n, e, convention) for n, e in expressions.items()}
        texts = {name: VELOCITY_TEXTS[name] for name in expressions}
    return TransferFunctions(diagram, Frozen(expressions), Frozen(texts))
