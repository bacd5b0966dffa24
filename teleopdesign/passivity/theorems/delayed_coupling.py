"""Absolute stability of a teleoperator whose master and slave are coupled by a late spring.

With dampings b_m, b_s of master and slave, stiffness P and one-way delay T, Llewellyn's criterion
reads b_m b_s >= (P T)^2 q(w), q = (sin(w T)/(w T))^2 <= 1, with equality for w -> 0.

The other conditions (`checker/matrices.py`) hold for every such coupling. The entries
have no pole but s = 0, where e^(-s T) = 1. The residues there are P, P and -P, so that
k11 k22 = k12 k21. At infinity the masses grow like s, and the coupling between the ports does not.
The product z12 z21 is bounded at high frequency.
"""

from __future__ import annotations

from ...realise.lti import S
from ..claims.claim import Claim, Proof
from ..linear.impedance import decimal
from ..two_port import absolutely_stable, teleoperator_two_port
from ._hypotheses import NonNegative, Real, certificate, require_hypotheses
from ._theorem import Theorem


@require_hypotheses
def delayed_spring(
    *,
    master_inertia: NonNegative,
    master_damping: Real,
    slave_inertia: NonNegative,
    slave_damping: Real,
    stiffness: NonNegative,
    delay: NonNegative,
) -> Claim:
    """Is the teleoperator absolutely stable: if and only if b_m, b_s >= 0 and b_m b_s >= (P T)^2?

    master_inertia, slave_inertia: kg;  master_damping, slave_damping: b_m, b_s, N s/m
    stiffness: P, N/m;  delay: T, one way, s
    returns: proved (equality allowed); else the verdict of `absolutely_stable`, which refutes by a
        wave with a passive termination at one port
    """
    b_m, b_s, k, late = master_damping, slave_damping, stiffness, delay
    statement = (
        f"the teleoperator with dampings {decimal(b_m)}, {decimal(b_s)} N s/m, spring "
        f"{decimal(k)} N/m and delay {decimal(late)} s each way is absolutely stable"
    )
    margin = b_m * b_s - (k * late) ** 2
    if min(b_m, b_s) < 0 or margin < 0:
        master, slave = master_inertia * S + b_m, slave_inertia * S + b_s
        coupled = teleoperator_two_port(
            master=master, slave=slave, stiffness=k, damping=0, delay=late
        )
        return Claim(statement, absolutely_stable(coupled).verdict)
    method = (
        "Llewellyn's criterion with the exact delay, b_m b_s >= (P T)^2, and residues at s = 0 "
        "that meet it with equality"
    )
    made = certificate("late_coupling", b_m=b_m, b_s=b_s, P=k, T=late)
    equality = "for w -> 0" if margin == 0 else ""
    return Claim(statement, Proof(method, (made,), float(margin), "(N s/m)^2", equality))


THEOREM = Theorem(mathematics=(delayed_spring,), order=70)
