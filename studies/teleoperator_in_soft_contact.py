"""How true is the force that a user feels of soft contact, with and without friction compensation?

Source: Mahvash, Okamura, "Friction compensation for a force-feedback telerobotic system", ICRA
2006, figure 7: force over displacement of the user with and without compensation of the slave, and
of the slave's tip. Rubber with a small loop of its own; machine and rubber are examples.

Finding: without compensation the user's loop is 1.7 N wide where the rubber's own is 0.1 N; the
friction's share is 2 f_C/(1 + k_e/P). With f_D = 0.9 f_C it is 0.35 N, and the force felt is that
of the tip within 0.11 N rms (0.95 N without). What remains is the coupling spring: the user feels
P k_e/(P + k_e), 470 N/m for the rubber's 630 N/m, whatever is cancelled.

    python studies/teleoperator_in_soft_contact.py [--quick] [--output DIR]
"""

from __future__ import annotations

from _slave_with_friction import two_sides
from _study import write_study

from teleopdesign.blocks import Body, Value, soft_rubber
from teleopdesign.simulate import ForceDisplacement, Trajectory, force_displacement, simulate, sine

STIFFNESS = 600.0  # of the rubber, N/m
RUBBER = {"stiffness": STIFFNESS, "damping": 1.0, "level": 0.1, "give": 1e-3, "position": 0.0}
#: part of the slave's friction that is cancelled, by case
CASES = {"no compensation": 0.0, "90 % cancelled": 0.9}
MIDDLE, AMPLITUDE, FREQUENCY = 4e-3, 6e-3, 0.2  # m, m, Hz: in and out of contact
WITHIN = (4e-3, 8e-3)  # m, where slope and width are read: in contact both ways


def press(frequency: float) -> Trajectory:
    """Into the rubber and out of it, about the middle."""
    one = sine(amplitude=AMPLITUDE, frequency=frequency)
    return Trajectory(lambda t: MIDDLE + one.position(t), one.velocity, one.acceleration)


def run(*, quick: bool = False) -> ForceDisplacement:
    """The last of two cycles of each case; quick: twice as fast."""
    frequency = 2 * FREQUENCY if quick else FREQUENCY
    rubber = soft_rubber(Body("prismatic", {"inertia": Value(0.0)}), **RUBBER)
    simulations = {
        case: simulate(
            two_sides(share, rubber),
            duration=2 / frequency,
            motion={"X_m": press(frequency)},
        )
        for case, share in CASES.items()
    }
    return force_displacement(simulations, within=WITHIN, after=1 / frequency)


def main() -> None:
    write_study(__file__, __doc__, run, quick="a faster motion")


if __name__ == "__main__":
    main()
