"""Energy tanks at the ends of a channel: never overdrawn, whatever the channel does.

Before a sample a tank contains W = E_0 + arrived - supplied. The held force f obeys abs(f) d <= W,
and f = 0 where W < 0. Over a travel x with abs(x) <= d the tank supplies f x <= abs(f) d <= W. So
the supplied energy is never above E_0 plus the largest count that has arrived: late, in any order,
held or interpolated. A count only grows, so the count that has arrived is at most the energy that
the other end has taken by now. Summed over both ends: the energy that the computers supply to the
bodies, less the energy that they take from the bodies, is at most 2 E_0.
"""

from __future__ import annotations

from ..claims.claim import Claim, Proof
from ..linear.impedance import decimal
from ._hypotheses import NonNegative, Positive, certificate, require_hypotheses
from ._theorem import Theorem


@require_hypotheses
def energy_tank(*, reserve: NonNegative, travel: Positive) -> Claim:
    """Bound of the energy that two ends with energy tanks (`energy_tanks`) release.

    reserve: E_0 in each tank, J;  travel: d, largest travel of any sample, m or rad
    returns: proved, if positions are exact, forces act as commanded and from their sample on, and
        counts of energy arrive no larger than they were sent; they may be late, jittered, lost or
        held
    """
    statement = (
        f"two ends with energy tanks of {decimal(reserve)} J give their bodies at most "
        f"{decimal(2 * reserve)} J more than they take from them, as long as no sample's travel "
        f"exceeds {decimal(travel)} m, positions are exact and commands act from their sample on"
    )
    method = "what a held force gives over the largest travel, and counts that only grow"
    force = reserve / travel
    made = certificate("energy_tank", W=reserve, F=force, f=force, d=travel)
    return Claim(statement, Proof(method, (made,), equality="at the largest travel"))


THEOREM = Theorem(mathematics=(energy_tank,), order=73)
