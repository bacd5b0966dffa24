"""The haptic interface: a device held by a hand, force feedback, cancellation, position loop.

    R_A = R_D + H (R_D - R_M) + C L + P     Z_M L = R_A - R_M
    R_H = -Z_H L                            R_M = -(R_H + R_V)
    R_D = K (L_D - L)                       where there is a position loop
    P = -alpha(R_M, L) dL/dt                where the port is watched (passivity controller)

Bernstein, Lawrence, Pao, World Haptics 2005, figures 1, 3 and 4. Only R_H = -Z_H L fits both the
sum R_M = -(R_H + R_V) and the total impedance Z_H + Z_M.
"""

from __future__ import annotations

from collections.abc import Collection

from ...base.errors import ModelError
from ...blocks import Body
from ...controllers import Controller
from ..junctions import Junction
from ..parts import ANY, AnyBlock, Attached, Block, Control, Moving, reads_command
from ..wiring import Diagram

TEXTS = {
    "R_D": "desired force",
    "R_A": "force commanded to the actuator",
    "R_M": "force of the device on the hand (the interaction force is its negative)",
    "R_V": "voluntary force of the hand on the device",
    "R_H": "passive force of the hand on the device",
    "E": "force error R_D - R_M",
    "R_FF": "force that the force feedback H adds",
    "R_MBC": "force that the motion-based cancellation C adds",
    "R_B": "force commanded without the motion-based cancellation C",
    "R_P": "force that the passivity controller P adds",
    "L": "motion of the device",
    "L_D": "reference of the motion",
    "L_E": "position error L_D - L",
}


def haptic_interface(
    device: Body | AnyBlock = ANY,
    *,
    hand: Body | AnyBlock | None = None,
    cancellation: Controller | AnyBlock | None = None,
    force_feedback: Controller | AnyBlock | None = None,
    position_loop: Controller | AnyBlock | None = None,
    passivity: Controller | AnyBlock | None = None,
    analog: Collection[str] = (),
) -> Diagram:
    """Wire a haptic interface; the diagram has only the blocks that are stated.

    device, hand: Z_M and Z_H, impedances relative to position
    cancellation: C, from the motion to a force;  force_feedback: H, from the force error R_D - R_M
        to a force
    position_loop: K, from the position error to R_D: a law that uses no velocity except the rate of
        its input (`lead`, `proportional_derivative`), because the velocity of the device has the
        other sign
    passivity: P, from R_M to a force, such as `passivity_controller`
    analog: controllers among "C", "H", "K" that no computer samples
    ANY stands for a block of which only the place is known.
    raises ModelError: `analog` names no controller, or the position loop uses a velocity

        >>> td.haptic_interface(cancellation=td.ANY, force_feedback=td.ANY)
        Diagram haptic interface
          Z_M L = R_A - R_M
          R_FF = H E
          R_MBC = C L
          E = R_D - R_M
          R_A = R_D + R_FF + R_MBC
          R_M = - R_V
          from outside: R_V, R_D
    """
    if unknown := set(analog) - {"C", "H", "K"}:
        raise ModelError(f'haptic interface: analog: no controller "{min(unknown)}", has C, H, K')
    blocks: list[Block] = [Moving("Z_M", device, "L", "R_A", {"R_M": -1}, "R_V")]
    command, on_hand = {"R_D": 1}, {"R_V": -1}
    junctions = [Junction("E", {"R_D": 1, "R_M": -1})]
    outside = {"R_V": "force"}
    if hand is not None:
        blocks.append(Attached("Z_H", hand, "L", "R_H", role="hand"))
        on_hand = {"R_H": -1, "R_V": -1}
    if force_feedback is not None:
        blocks.append(Control("H", force_feedback, "E", "R_FF", "L", "H" in analog))
        command["R_FF"] = 1
    if passivity is not None:
        blocks.append(Control("P", passivity, "R_M", "R_P", "L"))
        command["R_P"] = 1
    if cancellation is not None:
        others = ("R_B",) * reads_command(cancellation)
        junctions += [Junction(name, dict(command)) for name in others]
        blocks.append(Control("C", cancellation, "L", "R_MBC", "L", "C" in analog, others=others))
        command["R_MBC"] = 1
    if position_loop is None:
        outside["R_D"] = "force"
    else:
        _check_position_loop(position_loop)
        blocks.append(Control("K", position_loop, "L_E", "R_D", "L", "K" in analog))
        junctions.append(Junction("L_E", {"L_D": 1, "L": -1}))
        outside["L_D"] = "position"
    junctions += [Junction("R_A", command), Junction("R_M", on_hand)]
    made = {*outside, *(s for p in (*blocks, *junctions) for s in p.outputs)}
    return Diagram(
        "haptic interface",
        tuple(blocks),
        tuple(junctions),
        outside,
        measured=("L", "R_M"),
        texts={name: text for name, text in TEXTS.items() if name in made},
    )


def _check_position_loop(law: Controller | AnyBlock) -> None:
    """Raise ModelError if a damper would act on the device's velocity with the error's sign."""
    if isinstance(law, Controller) and law.sees_velocity:
        laws = ", ".join(stage.law.name for stage in law.stages)
        raise ModelError(
            f"haptic interface: position_loop: {laws} takes the device's velocity, and its damper "
            "would push along it: expected proportional_derivative or another law that "
            "differentiates its input"
        )


def four_cases(hybrid: Diagram, *, every: bool = False) -> dict[str, Diagram]:
    """The diagram without compensation, with cancellation, with force feedback, and with both.

    hybrid: a haptic interface with a cancellation C, a force feedback H, or both
    every: also the cases of a compensation that the diagram lacks, each of which equals another
    returns: case ("none", "MBC", "FF", "hybrid") -> diagram, as in the figures of the papers;
        without C or H, only the cases that remain
    """
    cases = {
        "none": hybrid.without("C", "H"),
        "MBC": hybrid.without("H"),
        "FF": hybrid.without("C"),
        "hybrid": hybrid,
    }
    present = {block.name for block in hybrid.blocks} & {"C", "H"}
    needed = {"none": set(), "MBC": {"C"}, "FF": {"H"}, "hybrid": {"C", "H"}}
    return {case: diagram for case, diagram in cases.items() if every or needed[case] <= present}


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return haptic_interface(hand=ANY, cancellation=ANY, force_feedback=ANY, position_loop=ANY)
