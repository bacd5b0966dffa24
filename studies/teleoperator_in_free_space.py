"""What does a user feel of the slave's friction in free space, with and without its cancellation?

Source: Mahvash, Okamura, "Friction compensation for a force-feedback telerobotic system", ICRA
2006, figure 6: displacement and force of the user over time, force over displacement. Only the
slave is compensated; the machine is an example, in units of the slave's friction f_C.

Finding: the loop that the user feels is 2 f_C wide without compensation and 2 (f_C - f_D) with it,
as the balance of forces says, and 0.1 N beside it for the damping: 0.3 N of 2.1 N are left with
f_D = 0.9 f_C. No oscillation comes with it, for the bristles of the cancellation are as soft as
passivity with presliding friction asks. Bristles stiffer than the friction's own would hold the
slave after each reversal and let it jump: a cancellation by motion cannot act before motion.

    python studies/teleoperator_in_free_space.py [--quick] [--output DIR]
"""

from __future__ import annotations

from _slave_with_friction import two_sides
from _study import write_study

from teleopdesign.simulate import ForceDisplacement, force_displacement, simulate, sine

#: part of the slave's friction that is cancelled, by case
CASES = {"no compensation": 0.0, "50 % cancelled": 0.5, "90 % cancelled": 0.9}
AMPLITUDE, FREQUENCY = 0.01, 0.2  # m, Hz: slow, so that friction is most of what is felt


def run(*, quick: bool = False) -> ForceDisplacement:
    """The last of two cycles of each case; quick: twice as fast."""
    frequency = 2 * FREQUENCY if quick else FREQUENCY
    simulations = {
        case: simulate(
            two_sides(share),
            duration=2 / frequency,
            motion={"X_m": sine(amplitude=AMPLITUDE, frequency=frequency)},
        )
        for case, share in CASES.items()
    }
    return force_displacement(simulations, after=1 / frequency)


def main() -> None:
    write_study(__file__, __doc__, run, quick="a faster motion")


if __name__ == "__main__":
    main()
