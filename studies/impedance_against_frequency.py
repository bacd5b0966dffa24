"""What does an impedance measured along one sweep say about friction?

Source: Bernstein, Lawrence, Pao, "Friction modeling and compensation for haptic interfaces", World
Haptics 2005, figure 7: apparent impedance Zhat_M from 1 to 100 Hz, four cases, the amplitude of
motion falling as f^-0.8. The factor of that profile cannot be read; it is chosen such that mass and
Coulomb friction weigh alike at 20 Hz (P20), where the paper sees two regimes part.

Finding: below 5 Hz Coulomb friction climbs by 16 dB/decade near 90 degrees, without compensation
(16.2) and with force feedback (16.9): the slope is that of the profile, 20 times 0.8, not of the
mechanism. Far above 20 Hz all four meet on the mass, 40 dB/decade at 180 degrees; without
compensation and with cancellation that is so from 50 Hz (38 to 40). With force feedback of 20 Hz
and gain 5 the way there is steeper (51 dB/decade from 50 to 100 Hz, phase up to 218 degrees): a
first-order filter lets its gain go only at 200 Hz, later than the paper's "above 20 Hz".

    python studies/impedance_against_frequency.py [--quick] [--output DIR]
"""

from __future__ import annotations

import numpy as np
from _study import write_study

from teleopdesign.diagrams import four_cases, reading, world_haptics_2005
from teleopdesign.frequency import (
    ImpedanceMap,
    falling,
    measured_impedance,
    quasi_linear_impedance,
)

CORNER = 20.0  # Hz
EXPONENT = 0.8


def profile_factor() -> float:
    """Amplitude at 1 Hz (m) of the profile on which mass and friction weigh alike at the corner."""
    # m omega^2 A = 4 F_C/pi with A = a_0 f^-0.8
    mass, level = reading("mass"), reading("coulomb_level")
    return level / (np.pi**3 * mass * CORNER ** (2 - EXPONENT))


def run(*, quick: bool = False) -> tuple[ImpedanceMap, ImpedanceMap]:
    """Simulated and quasi-linear impedance of the four cases from 1 to 400 Hz."""
    cases = four_cases(world_haptics_2005())
    frequency = np.array([1.0, 2, 5, 20, 50, 100, 200, 400])
    if not quick:
        frequency = np.geomspace(1.0, 400.0, 27)
    profile = falling(profile_factor(), exponent=EXPONENT)
    # continuous: at 400 Hz a sample of 1 ms is two fifths of a cycle
    measured = measured_impedance(
        cases, amplitude=profile, frequency=frequency, computer="continuous"
    )
    return measured, quasi_linear_impedance(cases, amplitude=profile, frequency=frequency)


def main() -> None:
    write_study(
        __file__,
        __doc__,
        run,
        quick="fewer frequencies",
        said=lambda maps: repr(maps[0]),
        figures=lambda maps: {
            "": maps[0].plot(model=maps[1]),
            "_two_columns": maps[0].plot(model=maps[1], columns=2),
        },
        numbers=lambda maps: maps[0],
    )


if __name__ == "__main__":
    main()
