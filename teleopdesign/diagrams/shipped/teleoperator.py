"""The teleoperator: a master held by a hand, a slave that meets an environment, and a coupling.

    Z_m X_m = F_m - P (X_m - X_s) + C_m X_m        F_m = F_u - Z_H X_m
    Z_s X_s = F_s + P (X_m - X_s) + C_s X_s        F_s = F_d - Z_E X_s

All forces act on master or slave, positive along its motion: F_m is all that the hand does, F_u the
user's part of it; F_s all that the environment does, F_d its active part. P is
position-position control (a spring, with a damper where wanted); C_m and C_s cancel friction by
motion. Mahvash, Okamura, ICRA 2006, eqs (10), (11), figures 3 and 4, in the signs of forces that
act: their eq (10) as printed would repel.
"""

from __future__ import annotations

from ...blocks import Body
from ...controllers import Controller
from ..junctions import Junction
from ..parts import ANY, AnyBlock, Attached, Block, Control, Moving, PortRole, reads_command
from ..wiring import Diagram

TEXTS = {
    "X_m": "motion of the master",
    "X_s": "motion of the slave",
    "X_e": "position error X_m - X_s",
    "F_u": "voluntary force of the user on the master",
    "F_H": "passive force of the hand on the master",
    "F_m": "force of the hand on the master",
    "F_d": "force of the environment on the slave that the slave's motion does not cause",
    "F_E": "passive force of the environment on the slave",
    "F_s": "force of the environment on the slave",
    "F_P": "force of the coupling on the slave, its negative on the master",
    "F_Cm": "force that the cancellation adds at the master",
    "F_Cs": "force that the cancellation adds at the slave",
    "B_m": "force commanded to the master's actuator without C_m",
    "B_s": "force commanded to the slave's actuator without C_s",
    "U_m": "force commanded to the master's actuator",
    "U_s": "force commanded to the slave's actuator",
}


def teleoperator(
    master: Body | AnyBlock = ANY,
    slave: Body | AnyBlock = ANY,
    *,
    coupling: Controller | AnyBlock = ANY,
    hand: Body | AnyBlock | None = None,
    environment: Body | AnyBlock | None = None,
    master_cancellation: Controller | AnyBlock | None = None,
    slave_cancellation: Controller | AnyBlock | None = None,
) -> Diagram:
    """Wire a teleoperator on one axis; the diagram has only the blocks that are stated.

    master, slave: Z_m and Z_s, impedances relative to position
    coupling: P, from the position error X_m - X_s to a force, such as `controller("spring_damper",
        ...)`
    hand: Z_H, passive impedance of the user's arm
    environment: Z_E, such as a body without inertia with the contact `CONTACT`
    master_cancellation, slave_cancellation: C_m and C_s, each on the motion of its side
    ANY stands for a block of which only the place is known.

        >>> device = td.hand(mass=0.2, damping=2.0, stiffness=0.0)
        >>> coupling = td.controller("spring_damper", {"stiffness": 500.0, "damping": 4.0})
        >>> td.teleoperator(device, device, coupling=coupling)
        Diagram teleoperator
          Z_m X_m = U_m + F_m
          Z_s X_s = U_s + F_s
          F_P = P X_e
          X_e = X_m - X_s
          F_m = F_u
          U_m = - F_P
          F_s = F_d
          U_s = F_P
          from outside: F_u, F_d
    """
    blocks: list[Block] = [
        Moving("Z_m", master, "X_m", "U_m", {"F_m": 1}, "F_u"),
        Moving("Z_s", slave, "X_s", "U_s", {"F_s": 1}, "F_d"),
        Control("P", coupling, "X_e", "F_P", "X_e"),
    ]
    junctions = [Junction("X_e", {"X_m": 1, "X_s": -1})]
    roles: dict[str, PortRole] = {"Z_H": "hand", "Z_E": "environment"}
    sides = (
        ("m", "F_u", -1, ("Z_H", hand, "F_H"), master_cancellation),
        ("s", "F_d", 1, ("Z_E", environment, "F_E"), slave_cancellation),
    )
    for side, outside_force, sign, (name, held, passive), cancellation in sides:
        motion, force = f"X_{side}", f"F_C{side}"
        on_body, command = {outside_force: 1}, {"F_P": sign}
        if held is not None:
            blocks.append(Attached(name, held, motion, passive, role=roles[name]))
            on_body[passive] = 1
        if cancellation is not None:
            others = (f"B_{side}",) if reads_command(cancellation) else ()
            blocks.append(Control(f"C_{side}", cancellation, motion, force, motion, others=others))
            junctions += [Junction(name, dict(command)) for name in others]
            command[force] = 1
        junctions += [Junction(f"F_{side}", on_body), Junction(f"U_{side}", command)]
    outside = {"F_u": "force", "F_d": "force"}
    made = {*outside, *(s for p in (*blocks, *junctions) for s in p.outputs)}
    return Diagram(
        "teleoperator",
        tuple(blocks),
        tuple(junctions),
        outside,
        measured=("X_m", "X_s"),
        texts={name: text for name, text in TEXTS.items() if name in made},
    )


def diagram() -> Diagram:
    """The wiring with every block that it can have."""
    return teleoperator(hand=ANY, environment=ANY, master_cancellation=ANY, slave_cancellation=ANY)
