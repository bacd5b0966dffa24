"""Two-ports: a teleoperator between the hand (port 1) and the environment (port 2).

    force_i = z_i1 velocity_1 + z_i2 velocity_2

Forces act from outside on the device, and velocities point the same way. So force times velocity is
the power that flows in, at both ports. Passive (Raisbeck): no motion of the ports takes energy out.
Absolutely stable (Llewellyn): with any two passive terminations, one at each port, no motion grows.
A passive two-port is absolutely stable. Dead times are exact: e^(-s T) is evaluated, not
approximated.

Llewellyn, Proc. IRE 40 (1952) 271. His inequality on the axis is one of several conditions;
`checker/matrices.py` lists all of them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
import sympy as sp

from ..base.arguments import describe_value
from ..base.errors import ModelError
from ..controllers import unseen_factor
from ..diagrams.control_parts import entry_of
from ..realise.lti import S
from .claims.claim import Claim
from .linear.family import Family, family_of_matrix
from .linear.impedance import Impedance, exact, impedance, not_decaying, read_expression
from .linear.judge import passive_claim, stable_claim


@dataclass(frozen=True)
class TwoPort:
    """A two-port by its impedance matrix.

    z: 2x2, N s/m, in `realise.lti.S`, with exact numbers
    unseen: modes of its systems that no port shows and that do not decay, 1/s
    """

    z: sp.ImmutableMatrix
    unseen: tuple[complex, ...] = ()

    @cached_property
    def family(self) -> Family:
        """The two-port as a family of functions, at a point."""
        return replace(family_of_matrix(self.z), unseen=self.unseen)

    def over(self, frequency: np.ndarray) -> np.ndarray:
        """Impedance matrices at each frequency (Hz), N s/m, (n, 2, 2)."""
        return self.at(2j * np.pi * np.asarray(frequency, dtype=float))

    def at(self, s: np.ndarray) -> np.ndarray:
        """Impedance matrices at each complex s (1/s), N s/m, (n, 2, 2)."""
        return self.family.at(np.asarray(s, dtype=complex))


def two_port(entries: Any) -> TwoPort:
    """A two-port from its impedances [[z11, z12], [z21, z22]], force over velocity.

    entries: N s/m, rational in s, with exp(-s T) for dead times; floats are read as decimals. Or
        systems of python-control, one for each entry, or one with two inputs and two outputs
    raises ModelError: another shape, a free symbol, a negative dead time, a discrete system
    """
    if hasattr(entries, "isdtime"):
        if (entries.ninputs, entries.noutputs) != (2, 2):
            raise ModelError(
                "two_port: expected two inputs and two outputs, found "
                f"{entries.ninputs} and {entries.noutputs}"
            )
        rows = [
            [impedance(entry_of(entries, i, j, "two_port")) for j in range(2)] for i in range(2)
        ]
        made = two_port(rows)
        if not len(getattr(entries, "A", ())):
            return made
        unseen = unseen_factor(entries.A, entries.B, entries.C, S)
        return replace(made, unseen=not_decaying(unseen))
    if isinstance(entries, sp.MatrixBase):
        entries = entries.tolist()
    if isinstance(entries, str) or not (_is_pair(entries) and all(map(_is_pair, entries))):
        raise ModelError(
            "two_port: expected [[z11, z12], [z21, z22]] or a system of python-control, found "
            f"{describe_value(entries)}"
        )
    rows = [[_entry(e) for e in row] for row in entries]
    modes = (mode for row in rows for e in row if isinstance(e, Impedance) for mode in e.unseen)
    z = [[e.expression if isinstance(e, Impedance) else e for e in row] for row in rows]
    return TwoPort(sp.ImmutableMatrix(z), tuple(modes))


def _is_pair(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, str) and len(value) == 2


def _entry(entry: Any) -> Impedance | sp.Expr:
    if hasattr(entry, "isdtime") or isinstance(entry, Impedance):
        return impedance(entry)
    e = read_expression(entry, S, "two_port")
    for power in e.atoms(sp.exp):
        rate = sp.Poly(power.args[0], S).all_coeffs() if power.args[0].is_polynomial(S) else []
        if len(rate) != 2 or rate[1] != 0 or rate[0] > 0:
            raise ModelError(f"two_port: expected a dead time exp(-s T), found {power}")
    return e


def teleoperator_two_port(
    *, master: Any, slave: Any, stiffness: float, damping: float = 0.0, delay: float = 0.0
) -> TwoPort:
    """A teleoperator: master and slave with a spring and a damper between their positions.

    master, slave: impedances, force over velocity, N s/m, see `impedance`
    stiffness: of the spring, N/m;  damping: of the damper, N s/m;  delay: each way, s
    """
    link = exact(stiffness) / S + exact(damping)
    late = sp.exp(-S * exact(delay)) if delay else sp.S(1)
    sides = impedance(master), impedance(slave)
    z1, z2 = (side.expression + link for side in sides)
    made = two_port([[z1, -link * late], [-link * late, z2]])
    return replace(made, unseen=(*sides[0].unseen, *sides[1].unseen))


def passive(system: TwoPort) -> Claim:
    """Is the two-port passive: does no motion of its two ports take energy out (Raisbeck)?

    The positive-real test of the matrix decides, poles on the axis included.

    returns: proved; or refuted by a growing wave; or, with dead times, evidence over frequency;
        unknown where no proof and no wave is available, or where a mode of a system of
        python-control that no port shows does not decay
    """
    return passive_claim(system.family)


def absolutely_stable(system: TwoPort) -> Claim:
    """Is the two-port stable between any passive terminations (Llewellyn, residues on the axis)?

    `checker/matrices.py` contains the statement and its proof.

    returns: proved; or refuted by a motion that grows by itself between the two passive
        terminations that the verdict names. With dead times: evidence over frequency, or refuted by
        a wave with which port 1 releases energy while port 2 has the termination that the verdict
        names; else unknown
    """
    return stable_claim(system.family)
