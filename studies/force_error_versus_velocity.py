"""How much friction does a hand feel that moves a haptic interface, and when?

Source: Bernstein, Lawrence, Pao, "Friction modeling and compensation for haptic interfaces", World
Haptics 2005, figure 5: force error R_D - R_M against velocity, motion prescribed, 1.5 Hz and 10 mm.

Finding: without compensation the hand feels the whole Coulomb level (0.51 N rms). Motion-based
cancellation removes it at speed (0.07 N left) but not at reversals (0.18 N rms); force feedback
divides it by 1 + k b/(b + |v|) everywhere (0.14 N rms); the hybrid leaves least (0.06 N rms) and no
visible hysteresis. What remains of the hybrid is the reversal itself, so its rms depends on how
ideal the Coulomb friction is: 0.054 N if the contact gives by 0.1 micrometres, 0.049 N for 1.

    python studies/force_error_versus_velocity.py [--quick] [--output DIR]
"""

from __future__ import annotations

from _study import write_study

from teleopdesign.diagrams import four_cases, read_open_number, world_haptics_2005
from teleopdesign.simulate import ForceVelocity, Sampling, force_velocity, simulate, sine

IDEAL = 1e-8  # m; the contact gives by this before it slides: 0.5 % of a reversal's sample


def run(*, quick: bool = False) -> ForceVelocity:
    """The force error of the four cases over one settled cycle; quick: a coarser contact."""
    frequency = read_open_number("frequency")
    cycles = 2 if quick else 4  # the slowest pole, 20 Hz, has settled after one
    motion = sine(amplitude=read_open_number("amplitude"), frequency=frequency)
    simulations = {
        case: simulate(
            diagram,
            duration=cycles / frequency,
            motion={"L": motion},
            computer=Sampling(period=read_open_number("sample_period")),
            give=1e-7 if quick else IDEAL,
            every_step=True,
        )
        for case, diagram in four_cases(world_haptics_2005()).items()
    }
    return force_velocity(simulations, after=(cycles - 1) / frequency)


def main() -> None:
    write_study(__file__, __doc__, run, quick="fewer cycles, a coarser contact")


if __name__ == "__main__":
    main()
