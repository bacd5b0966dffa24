"""How stiff may a virtual wall be, at which period, damping and encoder step?

Source: Colgate, Schenkel, J. Robotic Systems 14 (1997) 37; Abbott, Okamura, IEEE Trans. Robotics 21
(2005) 952; P50 and P51. A body with damping b and Coulomb friction f_C meets the sampled spring K;
its position is read in steps Delta. It is passive if and only if

    K <= min(2 b/T, 2 (f_C - f_D)/Delta)

where f_D is the friction that a compensator takes away. Each point of the two maps, over period and
stiffness and over damping and stiffness, is settled by the package's claim: a proof, or two
positions in turn that give out energy.

Finding: with 0.5 N of friction and steps of 0.1 mm the wall is limited by the encoder to 10 000 N/m
at short periods and by damping at long ones. Cancelling four fifths of the friction brings the
encoder's limit down to a fifth: full compensation leaves nothing for quantisation.

    python studies/passive_walls.py [--quick] [--output DIR]
"""

from __future__ import annotations

import numpy as np
import xarray
from _passivity_figures import plot_passive_walls
from _study import write_study

from teleopdesign.passivity import Claim, quantised_spring, region, stiffest_spring

FRICTION, STEP = 0.5, 1e-4  # N, m
DAMPING, PERIOD = 5.0, 1e-3  # N s/m, s: of the map that does not vary them
CANCELLED = (0.0, 0.4)  # N of that friction


def body(*, period: float, damping: float, cancelled: float) -> dict[str, float]:
    """What the wall meets, as the claim and the limit take it."""
    return {
        "sample_time": period,
        "damping": damping,
        "step": STEP,
        "coulomb_level": FRICTION,
        "compensator_level": cancelled,
    }


def statuses_of(bodies: dict[float, dict[str, float]], stiffnesses: np.ndarray) -> np.ndarray:
    """Status of each wall (a row each) beside each body, keyed by the axis of the map."""

    def claim(x: float, stiffness: float) -> Claim:
        return quantised_spring(stiffness=stiffness, **bodies[x])

    return region(claim, np.array(list(bodies)), stiffnesses).status.astype(str)


def run(*, quick: bool = False) -> xarray.Dataset:
    """Both maps, for friction as it is and four fifths of it cancelled; quick: 12 x 12 points."""
    n = 12 if quick else 40
    axes = {"period": np.geomspace(1e-4, 1e-2, n), "damping": np.geomspace(0.1, 30.0, n)}
    stiffnesses = np.geomspace(300.0, 30000.0, n)
    fixed = {"period": PERIOD, "damping": DAMPING}
    data, statuses = {}, []
    for name, values in axes.items():
        cases = [
            {float(x): body(**{**fixed, name: float(x)}, cancelled=f) for x in values}
            for f in CANCELLED
        ]
        status = np.array([statuses_of(case, stiffnesses) for case in cases])
        limit = [[stiffest_spring(**b) for b in case.values()] for case in cases]
        data[f"over_{name}"] = (("cancelled", "stiffness", name), status)
        data[f"limit_over_{name}"] = (("cancelled", name), np.array(limit), {"units": "N/m"})
        statuses.append(status)
    every = np.concatenate([s.ravel() for s in statuses])
    return xarray.Dataset(
        data,
        {
            "cancelled": ("cancelled", list(CANCELLED), {"units": "N"}),
            "stiffness": ("stiffness", stiffnesses, {"units": "N/m"}),
            "period": ("period", axes["period"], {"units": "s"}),
            "damping": ("damping", axes["damping"], {"units": "N*s/m"}),
        },
        {
            "fixed_damping": DAMPING,
            "fixed_period": PERIOD,
            "finding": f"{every.size} walls: {int((every == 'proved').sum())} proved, "
            f"{int((every == 'refuted').sum())} refuted by a motion, "
            f"{int((every == 'unknown').sum())} unknown",
        },
    )


if __name__ == "__main__":
    write_study(__file__, __doc__, run, plot=plot_passive_walls)
