"""What does an impedance measured along one sweep say about friction?

Source: Bernstein, Lawrence, Pao, "Friction modeling and compensation for haptic interfaces", World
Haptics 2005, figure 7: apparent impedance Zhat_M from 1 to 100 Hz, four cases, the amplitude of
motion falling as f^-0.8. The factor of that profile cannot be read. Two readings: 2.95 mm at 1 Hz,
with which mass and Coulomb friction weigh alike at 20 Hz (P20), where the paper sees two regimes
part; and 10 mm at 1 Hz, the largest amplitude of its figure 6.

Finding: below 5 Hz Coulomb friction climbs by 16 dB/decade near 90 degrees, without compensation
(16.2) and with force feedback (16.9): the slope is that of the profile, 20 times 0.8, not of the
mechanism. Far above 20 Hz all four meet on the mass, 40 dB/decade at 180 degrees; without
compensation and with cancellation that is so from 50 Hz (38 to 40). With force feedback of 20 Hz
and gain 5 the way there is steeper (51 dB/decade from 50 to 100 Hz, phase up to 218 degrees): a
first-order filter lets its gain go only at 200 Hz, later than the paper's "above 20 Hz". Two claims
of the paper conflict: with the corner at 20 Hz, cancellation alone is at 107 degrees at 4 Hz, not
mass-like "down to 4 Hz"; with 10 mm it is at 157 degrees there, but the corner lies at 7.2 Hz.

    python studies/impedance_against_frequency.py [--quick] [--output DIR]
"""

from __future__ import annotations

import numpy as np
from _study import write_study

from teleopdesign.diagrams import four_cases, read_open_number, world_haptics_2005
from teleopdesign.frequency import (
    ImpedanceMap,
    falling_profile,
    measured_impedance,
    quasi_linear_impedance,
)

CORNER = 20.0  # Hz
#: m at 1 Hz; the other reading of the profile's factor
TEN_MILLIMETRES = 1e-2
#: Hz, down to which the paper calls MBC mass-like
MASS_LIKE = 4.0
EXPONENT = 0.8


def profile_factor() -> float:
    """Amplitude at 1 Hz (m) of the profile on which mass and friction weigh alike at the corner."""
    # m omega^2 A = 4 F_C/pi with A = a_0 f^-0.8
    mass, level = read_open_number("mass"), read_open_number("coulomb_level")
    return level / (np.pi**3 * mass * CORNER ** (2 - EXPONENT))


def corner_of(factor: float) -> float:
    """Frequency (Hz) at which mass and friction weigh alike on the profile of that factor (m)."""
    weight = read_open_number("coulomb_level") / (np.pi**3 * read_open_number("mass") * factor)
    return float(weight ** (1 / (2 - EXPONENT)))


def phases_of_cancellation() -> dict[float, float]:
    """Factor of the profile (m) -> phase (degrees) of MBC at 4 Hz, where it should be mass-like."""
    cases = {"MBC": four_cases(world_haptics_2005())["MBC"]}
    return {
        factor: float(
            measured_impedance(
                cases,
                amplitude=falling_profile(factor, exponent=EXPONENT),
                frequency=[MASS_LIKE],
                computer="continuous",
            ).phase.values.item()
        )
        for factor in (profile_factor(), TEN_MILLIMETRES)
    }


def run(*, quick: bool = False) -> tuple[ImpedanceMap, ImpedanceMap]:
    """Simulated and quasi-linear impedance of the four cases from 1 to 400 Hz."""
    cases = four_cases(world_haptics_2005())
    frequency = np.array([1.0, 2, 5, 20, 50, 100, 200, 400])
    if not quick:
        frequency = np.geomspace(1.0, 400.0, 27)
    profile = falling_profile(profile_factor(), exponent=EXPONENT)
    # continuous: at 400 Hz a sample of 1 ms is two fifths of a cycle
    measured = measured_impedance(
        cases, amplitude=profile, frequency=frequency, computer="continuous"
    )
    return measured, quasi_linear_impedance(cases, amplitude=profile, frequency=frequency)


def at_ten_millimetres(*, quick: bool = False) -> tuple[ImpedanceMap, ImpedanceMap]:
    """The same with the other reading of the profile's factor, up to 100 Hz."""
    cases = four_cases(world_haptics_2005())
    frequency = np.array([1.0, 4, 20, 100]) if quick else np.geomspace(1.0, 100.0, 19)
    profile = falling_profile(TEN_MILLIMETRES, exponent=EXPONENT)
    measured = measured_impedance(
        cases, amplitude=profile, frequency=frequency, computer="continuous"
    )
    return measured, quasi_linear_impedance(cases, amplitude=profile, frequency=frequency)


def both(*, quick: bool = False) -> tuple[ImpedanceMap, ...]:
    """The maps of both readings, simulated and quasi-linear each."""
    return *run(quick=quick), *at_ten_millimetres(quick=quick)


def summary(maps: tuple[ImpedanceMap, ...]) -> str:
    """The map, and what the two readings make of MBC at 4 Hz."""
    lines = [
        f"A = {1e3 * factor:.3g} mm at 1 Hz: corner at {corner_of(factor):.3g} Hz, MBC at "
        f"{phase:.0f} degrees at {MASS_LIKE:g} Hz"
        for factor, phase in phases_of_cancellation().items()
    ]
    return "\n".join([repr(maps[0]), *lines])


def main() -> None:
    write_study(
        __file__,
        __doc__,
        both,
        quick="fewer frequencies",
        text=summary,
        figures=lambda maps: {
            "": maps[0].plot(model=maps[1]),
            "_two_columns": maps[0].plot(model=maps[1], columns=2),
            "_ten_millimetres": maps[2].plot(model=maps[3]),
        },
        numbers=lambda maps: maps[0],
    )


if __name__ == "__main__":
    main()
