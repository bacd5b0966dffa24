"""The block diagrams of the two papers, drawn from the wiring that everything else is derived from.

Source: Bernstein, Lawrence, Pao, World Haptics 2005, figures 1 (open loop), 3 (force feedback and
cancellation) and 4 (position loop); Mahvash, Okamura, ICRA 2006, figures 3 (user, master, slave,
environment), 4 (a compensator for each joint, here two of them) and 8 (friction and its
cancellation as one block on the motion).

Finding: figure 8 is the passivity argument: friction less its cancellation is one element of the
motion, and the rest of the loop need not be known.

    python studies/block_diagrams.py [--quick] [--output DIR]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from teleopdesign.blocks import Body, Value
from teleopdesign.controllers import controller
from teleopdesign.diagrams import (
    ANY,
    Arm,
    Attached,
    Control,
    Diagram,
    Junction,
    Moving,
    haptic_interface,
    teleoperator,
    teleoperator_of_arms,
    tip_coordinates,
    write_diagram,
)
from teleopdesign.show import draw_diagram, save_figure

NAME = "block_diagrams"


def joints() -> Diagram:
    """Two arms of two joints, the slave's compensated one by one."""
    body = Body("revolute", {"inertia": Value(0.1)})
    dahl = controller("dahl", {"level": 0.1, "stiffness": 100.0})
    tip = tip_coordinates(np.eye(2))
    slave = Arm((body, body), tip, (dahl, dahl))
    return teleoperator_of_arms(Arm((body, body), tip), slave, stiffness=500.0 * np.eye(2))


def pair() -> Diagram:
    """Friction less its cancellation, between a motion and the force that it takes."""
    return Diagram(
        "friction and its cancellation",
        (
            Moving("Z", ANY, "X", "U", {"F_pair": -1}, "F"),
            Attached("f_C", ANY, "X", "F_C", sign=1),
            Control("f_D", ANY, "X", "F_D", "X"),
        ),
        (Junction("F_pair", {"F_C": 1, "F_D": -1}), Junction("U", {"F": 1})),
        {"F": "force"},
        measured=("X",),
    )


def run() -> dict[str, Diagram]:
    """Figure -> its diagram."""
    return {
        "interface_open_loop": haptic_interface(hand=ANY),
        "interface_compensated": haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY),
        "interface_position_loop": haptic_interface(
            hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY
        ),
        "teleoperator": teleoperator(hand=ANY, environment=ANY, slave_cancellation=ANY),
        "teleoperator_joint_by_joint": joints(),
        "friction_and_cancellation": pair(),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="the same: nothing is computed")
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "output")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    for name, diagram in run().items():
        path = arguments.output / f"{NAME}_{name}"
        save_figure(draw_diagram(diagram).plot(), path)
        write_diagram(diagram, path.with_suffix(".toml"))
        print(f"{name}: {len(diagram.blocks)} blocks, {len(diagram.signals)} signals")


if __name__ == "__main__":
    main()
