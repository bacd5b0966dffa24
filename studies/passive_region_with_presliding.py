"""Which Dahl compensators are passive on a joint whose friction gives before it slides?

Source: an extension of Mahvash, Okamura, ICRA 2006 (P43). Plant and compensator are Dahl friction
(sigma_p, f_C) and (sigma_D, f_D) on the same position; the pair is passive if and only if

    (sigma_D/sigma_p)^2 <= f_D/f_C <= 1

Each point of the map is settled twice: by the package's claim (a proof with certificate, or an
exactly integrated cycle that gives out energy), and by simulating motions with the compiled kernel
(sinusoids, and stops and reversals, of many sizes) in search of one that gives out energy.

Finding: the wedge, without a contradiction: no motion was found at a point that is proved, and
motions were found at nearly all others. Missed are points next to the boundary, where it would take
many more rounds, or longer strokes, than were tried. At a stiffness above sqrt(f_D/f_C) sigma_p
lowering f_D makes it worse: small motion sees the stiffnesses alone.

    python studies/passive_region_with_presliding.py [--quick] [--output DIR]
"""

from __future__ import annotations

import numpy as np
import xarray
from _passivity_figures import plot_passive_region
from _study import values_over, write_study

import teleopdesign as td
from teleopdesign.controllers import controller
from teleopdesign.diagrams import Diagram, haptic_interface
from teleopdesign.passivity import Claim, Strokes, confirmed_motion, dahl_compensation, region

FRICTION, PRESLIDING = 1.0, 1e4  # N, N/m: bristle length 0.1 mm
LENGTH = FRICTION / PRESLIDING


def claim(softness: float, share: float) -> Claim:
    """The package's claim at sigma_D = softness sigma_p, f_D = share f_C."""
    return dahl_compensation(
        coulomb_level=FRICTION,
        presliding_stiffness=PRESLIDING,
        compensator_level=share * FRICTION,
        compensator_stiffness=softness * PRESLIDING,
    )


def joint(softness: float, share: float) -> Diagram:
    """The same pair as a diagram; the inertia gives back what it takes."""
    body = td.Body("prismatic", {"inertia": td.Value(1e-3)})
    body = body.with_effect(td.EFFECTS["coulomb"], {"level": FRICTION})
    presliding = td.EFFECTS["presliding"].without("bristle_damping")
    body = body.with_effect(presliding, {"stiffness": PRESLIDING})
    values = {"level": share * FRICTION, "stiffness": softness * PRESLIDING}
    return haptic_interface(body, cancellation=controller("dahl", values))


def motions(number: int) -> list[Strokes]:
    """Sinusoids of 0.1 to 300 bristle lengths, and the same with a step back at each reversal."""
    strokes = []
    sizes = LENGTH * np.geomspace(0.1, 300.0, number)
    for a in sizes[np.argsort(-np.abs(np.log(sizes / LENGTH)))]:  # the extremes show most
        speed = 300 * a  # friction does not depend on it; a stroke then takes 10 ms
        strokes.append(Strokes((a, -a), speed))
        strokes.append(Strokes((a, 0.9 * a, a, -a, -0.9 * a, -a), speed))
    return strokes


def gives_out(softness: float, share: float, tested: list[Strokes]) -> bool:
    """Whether one of those motions gives out energy, from rest to rest and beyond doubt."""
    diagram = joint(softness, share)
    return any(confirmed_motion(diagram, motion) is not None for motion in tested)


def run(*, quick: bool = False) -> xarray.Dataset:
    """Both verdicts over the map; quick: 5 x 5 points."""
    n = 5 if quick else 31
    softness, share = np.linspace(0.05, 1.25, n), np.linspace(0.05, 1.25, n)
    proofs = region(claim, softness, share)
    tested = motions(5 if quick else 8)

    def beyond(share: float, softness: float) -> bool:
        return gives_out(softness, share, tested)

    gives = values_over(beyond, {"share": share, "softness": softness}) > 0
    proved = proofs.status == "proved"
    dims = ("share", "softness")
    return xarray.Dataset(
        {
            "status": (dims, proofs.status.astype(str)),
            "found": (dims, gives.astype(int), {"how": "searched by simulation"}),
        },
        {
            "softness": ("softness", softness, {"units": "1", "text": "sigma_D/sigma_p"}),
            "share": ("share", share, {"units": "1", "text": "f_D/f_C"}),
        },
        {
            "contradictions": int((proved & gives).sum()),
            "missed": int((~proved & ~gives).sum()),
            "finding": f"{proved.size} points, {proved.sum()} proved; a motion that gives out "
            f"energy found at {int((proved & gives).sum())} of these and at "
            f"{int((~proved & gives).sum())} of the {int((~proved).sum())} others",
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_passive_region)
