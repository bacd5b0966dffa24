"""How heavy does a haptic interface feel in small and in large motion?

Source: Bernstein, Lawrence, Pao, "Friction modeling and compensation for haptic interfaces", World
Haptics 2005, figure 6: apparent impedance Zhat_M against the amplitude of motion at one frequency
(5 Hz), four cases; motion prescribed, first harmonic of the force error R_D - R_M.

Finding: none of the four is linear, for a linear mechanism would give horizontal lines. Without
compensation |Zhat_M| falls by 20 dB/decade in small motion, as Coulomb friction does, and settles
at m omega^2 (43.4 dB) in large motion; force feedback lowers that by 14 dB at 1 mm and by 7 dB at
20 mm, for its gain falls with speed, so that it has a minimum over amplitude (34.4 dB near 7 mm).
So has the hybrid (31.0 dB near 2.3 mm, the dip that the paper shows at 2 mm) without cancelling
more than there is; cancellation alone has none. Describing functions (lines) predict the simulated
values (points) within 0.8 dB and 3 degrees.

    python studies/impedance_against_amplitude.py [--quick] [--output DIR]
"""

from __future__ import annotations

import numpy as np
from _study import write_study

from teleopdesign.diagrams import four_cases, read_open_number, world_haptics_2005
from teleopdesign.frequency import ImpedanceMap, measured_impedance, quasi_linear_impedance
from teleopdesign.simulate import Sampling

FREQUENCY = 5.0  # Hz; the reading of figure 6 whose corner amplitude, 4 mm, lies in its range


def run(*, quick: bool = False) -> tuple[ImpedanceMap, ImpedanceMap]:
    """Simulated and quasi-linear impedance of the four cases from 0.5 to 20 mm."""
    cases = four_cases(world_haptics_2005())
    amplitude = 1e-3 * np.geomspace(0.5, 20.0, 5 if quick else 25)
    period = Sampling(period=read_open_number("sample_period"))
    measured = measured_impedance(cases, amplitude=amplitude, frequency=FREQUENCY, computer=period)
    return measured, quasi_linear_impedance(cases, amplitude=amplitude, frequency=FREQUENCY)


def main() -> None:
    write_study(
        __file__,
        __doc__,
        run,
        quick="fewer amplitudes",
        text=lambda maps: repr(maps[0]),
        figures=lambda maps: {
            "": maps[0].plot(model=maps[1]),
            "_two_columns": maps[0].plot(model=maps[1], columns=2),
        },
        numbers=lambda maps: maps[0],
    )


if __name__ == "__main__":
    main()
