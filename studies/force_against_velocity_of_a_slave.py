"""How does the force that moves a slave's joint depend on its velocity, near rest and away from it?

Source: Mahvash, Okamura, "Friction compensation for a force-feedback telerobotic system", ICRA
2006, figure 2: velocity against time, and force over the Coulomb level against velocity, for the
prismatic joint of a slave that moves smoothly back and forth. The paper identifies its Coulomb
level from this curve. No number of the joint is printed there; those used here are round ones of
the size that a public recording of such a joint shows (0.6 N on 0.45 kg).

Finding: away from rest the curve is two branches at +1 and -1: half the distance of their means is
the Coulomb level to 0.1 %, for the force of inertia cancels between speeding up and slowing down.
Near rest it is a loop, not a jump: after a reversal the force keeps its sign until the contact has
given by its bristle length, and the speed at which it crosses zero grows as the root of that length
(6.5 mm/s for 0.2 mm, 13.0 mm/s for 0.8 mm). Without presliding the same curve jumps at zero speed.

    python studies/force_against_velocity_of_a_slave.py [--quick] [--output DIR]
"""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from _normalised_force_figure import plot_normalised_force

from teleopdesign import EFFECTS, Body, Value
from teleopdesign.diagrams import haptic_interface
from teleopdesign.show import save_figure
from teleopdesign.simulate import ForceVelocity, force_velocity, simulate, sine

NAME = "force_against_velocity_of_a_slave"
LEVEL, INERTIA = 0.6, 0.45  # N, kg
AMPLITUDE, FREQUENCY = 0.03, 0.4  # m, Hz: up to 75 mm/s, inertia at most 0.14 of the level
#: bristle lengths lambda_p = f_C/sigma_p, m; 0: ideal Coulomb friction
BRISTLE_LENGTHS = {"presliding 0.2 mm": 2e-4, "presliding 0.8 mm": 8e-4, "ideal Coulomb": 0.0}
STEP = 2e-5  # s: ten steps for the reload of the ideal contact, which gives by 0.1 um
#: part of the peak speed above which a branch is read
BRANCH = 0.5


@dataclass(frozen=True)
class Curves:
    """Force against velocity, a case a bristle length, and what is read off.

    level: case -> half the difference of the mean forces of both branches, N
    crossing: case -> speed at which the force crosses zero after a reversal, m/s
    """

    curves: ForceVelocity
    level: dict[str, float]
    crossing: dict[str, float]

    def __repr__(self) -> str:
        lines = ["Force of a joint against velocity"]
        for case, level in self.level.items():
            lines.append(
                f"  {case:<18} level {level:.4f} N, after a reversal the force crosses zero at "
                f"{1e3 * self.crossing[case]:.2f} mm/s"
            )
        return "\n".join(lines)


def joint(bristle_length: float) -> Body:
    """The joint with that bristle length, m; 0: ideal Coulomb friction."""
    body = Body("prismatic", {"inertia": Value(INERTIA)})
    body = body.with_effect(EFFECTS["coulomb"], {"level": LEVEL})
    if bristle_length == 0.0:
        return body
    return body.with_effect(EFFECTS["presliding"], {"stiffness": LEVEL / bristle_length})


def run(*, quick: bool = False) -> Curves:
    """The curves over one settled cycle; quick: fewer cycles."""
    cycles = 2 if quick else 3
    motion = sine(amplitude=AMPLITUDE, frequency=FREQUENCY)
    simulations = {
        case: simulate(
            haptic_interface(joint(length)),
            duration=cycles / FREQUENCY,
            motion={"L": motion},
            computer="continuous",
            step=STEP,
            give=1e-7,
            every_step=True,
        )
        for case, length in BRISTLE_LENGTHS.items()
    }
    curves = force_velocity(simulations, after=(cycles - 1) / FREQUENCY)
    cases = list(simulations)
    return Curves(
        curves,
        {case: branch_level(curves, case) for case in cases},
        {case: zero_crossing(curves, case) for case in cases},
    )


def branch_level(curves: ForceVelocity, case: str) -> float:
    """Half the difference of the mean forces forward and backward, N."""
    one = curves.data.sel(case=case)
    force, velocity = one["force"].values, one["velocity"].values
    fast = BRANCH * float(np.abs(velocity).max())
    return float(force[velocity > fast].mean() - force[velocity < -fast].mean()) / 2


def zero_crossing(curves: ForceVelocity, case: str) -> float:
    """Speed at which the force changes its sign after the first reversal, m/s."""
    one = curves.data.sel(case=case)
    force, velocity = one["force"].values, one["velocity"].values
    turned = int(np.argmax(np.sign(velocity) != np.sign(velocity[0])))
    later = turned + int(np.argmax(np.sign(force[turned:]) != np.sign(force[0])))
    return float(abs(velocity[later]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="fewer cycles")
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    result = run(quick=arguments.quick)
    print(result)
    path = arguments.output / NAME
    figure = plot_normalised_force(result.curves, level=result.level)
    save_figure(figure, path)
    result.curves.to_netcdf(path.with_suffix(".nc"))
    numbers = {"level_N": result.level, "crossing_m_per_s": result.crossing}
    path.with_suffix(".json").write_text(json.dumps(numbers, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
