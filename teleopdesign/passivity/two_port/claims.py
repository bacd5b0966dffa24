"""Claims of passivity and of absolute stability of a two-port."""

from __future__ import annotations

from ..claims.claim import Claim, Unknown
from ..linear.judge import passive_claim, stable_claim
from ..linear.unseen import explain_unseen
from .two_port import TwoPort


def passive(system: TwoPort) -> Claim:
    """Is the two-port passive: does no motion of its two ports take energy out (Raisbeck)?

    The positive-real test of the matrix decides, poles on the axis included.

    returns: proved; or refuted by a growing wave; or, with dead times, evidence over frequency;
        unknown where no proof and no wave is available, or where a mode of a system of
        python-control that no port shows does not decay
    """
    return _with_unseen(system, passive_claim(system.family))


def absolutely_stable(system: TwoPort) -> Claim:
    """Is the two-port stable between any passive terminations (Llewellyn, residues on the axis)?

    `checker/absolute_stability.py` contains the statement and its proof.

    returns: proved; or refuted by a motion that grows by itself between the two passive
        terminations that the verdict names. With dead times: evidence over frequency, or refuted by
        a wave with which port 1 releases energy while port 2 has the termination that the verdict
        names; else unknown
    """
    return _with_unseen(system, stable_claim(system.family))


def _with_unseen(system: TwoPort, claim: Claim) -> Claim:
    """The claim; unknown if it holds while modes that no port shows do not decay."""
    if claim.holds and system.unseen:
        return Claim(claim.statement, Unknown(explain_unseen(system.unseen)))
    return claim
