"""Absolute stability of a teleoperator whose master and slave are coupled by a late spring.

With dampings b_m, b_s of master and slave, stiffness P and one-way delay T, Llewellyn's criterion
reads b_m b_s >= (P T)^2 q(w), q = (sin(w T)/(w T))^2 <= 1, with equality for w -> 0.

The other conditions (`checker/absolute_stability.py`) hold for every such coupling. The entries
have no pole but s = 0, where e^(-s T) = 1. The residues there are P, P and -P, so that
k11 k22 = k12 k21. At infinity the masses grow like s, and the coupling between the ports does not.
The product z12 z21 is bounded at high frequency.
"""

from __future__ import annotations

from typing import Any

import sympy as sp

from ..claims.certificate import Certificate, storage_certificate
from ..claims.claim import Claim, Proof
from ..linear.impedance import decimal, exact
from ..two_port.claims import absolutely_stable
from ..two_port.two_port import teleoperator_two_port
from ._dahl_certificates import Values
from ._hypotheses import NOT_NEGATIVE, REAL, require_hypotheses
from ._theorem import Theorem


@require_hypotheses(
    master_inertia=NOT_NEGATIVE,
    master_damping=REAL,
    slave_inertia=NOT_NEGATIVE,
    slave_damping=REAL,
    stiffness=NOT_NEGATIVE,
    delay=NOT_NEGATIVE,
)
def delayed_spring(
    *,
    master_inertia: Any,
    master_damping: Any,
    slave_inertia: Any,
    slave_damping: Any,
    stiffness: Any,
    delay: Any,
) -> Claim:
    """Is the teleoperator absolutely stable: if and only if b_m, b_s >= 0 and b_m b_s >= (P T)^2?

    master_inertia, slave_inertia: kg;  master_damping, slave_damping: b_m, b_s, N s/m
    stiffness: P, N/m;  delay: T, one way, s
    returns: proved (equality allowed); else the verdict of `absolutely_stable`, which refutes by a
        wave with a passive termination at one port
    raises ModelError: an argument outside of its hypothesis
    """
    b_m, b_s, k, late = map(exact, (master_damping, slave_damping, stiffness, delay))
    master, slave = (
        exact(m) * sp.Symbol("s") + b for m, b in ((master_inertia, b_m), (slave_inertia, b_s))
    )
    statement = (
        f"the teleoperator with dampings {decimal(b_m)}, {decimal(b_s)} N s/m, spring "
        f"{decimal(k)} N/m and delay {decimal(late)} s each way is absolutely stable"
    )
    if min(b_m, b_s) >= 0 and b_m * b_s >= (k * late) ** 2:
        method = (
            "Llewellyn's criterion with the exact delay, b_m b_s >= (P T)^2, and residues at s = 0 "
            "that meet it with equality"
        )
        margin = float(b_m * b_s - (k * late) ** 2)
        equality = "for w -> 0" if margin == 0 else ""
        certificate = _certificate({"b_m": b_m, "b_s": b_s, "P": k, "T": late})
        return Claim(statement, Proof(method, (certificate,), margin, "(N s/m)^2", equality))
    general = absolutely_stable(
        teleoperator_two_port(master=master, slave=slave, stiffness=k, damping=0, delay=late)
    )
    return Claim(statement, general.verdict)


def _certificate(values: Values) -> Certificate:
    """Certificate of Llewellyn's inequality for this coupling; values: b_m, b_s, P, T."""
    b_m, b_s, k, late, q = sp.symbols("b_m b_s P T q", real=True)
    enough = b_m * b_s - (k * late) ** 2
    return storage_certificate(
        "b_m b_s - (P T)^2 q >= 0 for 0 <= q <= 1: Llewellyn's inequality at every frequency",
        supply=b_m * b_s - (k * late) ** 2 * q,
        nonnegative={"enough": enough, "below_one": 1 - q, "q": q},
        proofs={
            "supply": {"": [(1, {"enough": 1}, 1), (1, {"below_one": 1}, k * late)]},
            "storage": {"": ()},
        },
        example={**values, "q": 1},
    )


THEOREM = Theorem(mathematics=(delayed_spring,), order=70)
