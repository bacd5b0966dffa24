"""Right and false names on drawn interfaces.

    PYTHONPATH=tests python -m block_cuts.campaign FOLDER [--seed 1] [--size 0.25] [--averages]

Each hidden effect of `HIDDEN` is planted once in an interface of its own. Printed: a row a case,
then how many are right, and how many were named falsely. Of effects in the
computer only the cut of the command is compared: bodies take longest.
"""

import argparse
from pathlib import Path

import numpy as np
from block_cuts.interface_simulator import draw_interface, write_case

import teleopdesign as td

HIDDEN = [
    {("gain", "H"): 1.06}, {("delay", "H"): 0.004}, {("lag", "H"): 0.004},
    {("saturation", "H"): 0.5}, {("dead_zone", "H"): 0.05}, {("velocity_filter", "H"): 0.006},
    {("gain", "C"): 0.9}, {("delay", "C"): 0.003}, {("lag", "C"): 0.005},
    {("velocity_filter", "C"): 0.005}, {("bias", "C"): 0.02},
    {("gain", "computer"): 1.04}, {("delay", "computer"): 0.003}, {("lag", "computer"): 0.003},
    {("dead_zone", "computer"): 0.06}, {("bias", "computer"): -0.015},
    {("stribeck", "Z_M"): 0.15}, {("quadratic_drag", "Z_M"): 6.0}, {("bias", "Z_M"): 0.12},
    {("hardening_spring", "Z_H"): 1.5e6}, {("viscous_asymmetry", "Z_H"): 0.6},
    {}, {}, {}, {},
]  # fmt: skip


def judge(diagnosis, hidden):
    """Whether the answer is right: the effect named, or listed in a group of its like."""
    if not hidden:
        return diagnosis.verdict == "model_adequate"
    (true,) = hidden
    listed = any(true in group for group in diagnosis.groups)
    return diagnosis.missing == (true,) or (not diagnosis.missing and listed)


def shrink(hidden, size):
    """The hidden effect at a part of its size; a limit keeps its value."""
    if size == 1.0:
        return hidden
    made = {}
    for (effect, at), value in hidden.items():
        absent = 1.0 if effect == "gain" else 0.0
        less = absent + size * (value - absent)
        made[effect, at] = value if effect == "saturation" else less
    return made


def main(folder, seed, size, averages, first):
    right = false = 0
    for number, hidden in list(enumerate(HIDDEN))[first:]:
        hidden = shrink(hidden, size)
        random = np.random.default_rng([seed, number])
        interface = draw_interface(random)
        interface.hidden, interface.averages = hidden, averages
        place = Path(folder) / f"{number:03}"
        if not (place / "experiment.toml").exists():
            write_case(interface, place, random)
        # all signals between were recorded, so what is hidden in the computer changes no body
        at = ("R_A",) if {block for _, block in hidden} & {"H", "C", "computer"} else None
        diagnosis = td.find_missing(td.load_experiment(place), at=at)
        is_right = judge(diagnosis, hidden)
        false_names = [key for key in diagnosis.missing if key not in hidden]
        right, false = right + is_right, false + bool(false_names)
        left = ", ".join(f"{name} {x:.2f}" for name, x in diagnosis.left.items())
        print(
            f"{number:03} {'right' if is_right else 'WRONG'} planted {list(hidden)} "
            f"verdict {diagnosis.verdict} {diagnosis.missing} groups {diagnosis.groups} "
            f"left in floors: {left}",
            flush=True,
        )
    print(f"{right} of {len(HIDDEN) - first} right, {false} with a false name")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--size", type=float, default=1.0, help="part of the effects' sizes")
    parser.add_argument("--averages", action="store_true", help="the force sensor averages")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    options = parser.parse_args()
    main(options.folder, options.seed, options.size, options.averages, options.first)
