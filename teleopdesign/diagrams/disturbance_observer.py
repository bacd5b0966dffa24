"""Disturbance observer: it estimates all forces on a body besides its command, and cancels them.

    d = Q (M_n dv/dt + B_n v) - Q u,   u = u_0 - d,   Q = g/(s + g)

Q/(1 - Q) = g/s, so u = (1 + g/s) u_0 - g (M_n + B_n/s) v. To its port a body M s + B is then, for
any M_n and B_n >= 0 and in continuous time, richer by a damper g M_n and a spring g B_n, so it is
passive. Where M_n = M, B_n = B it follows u_0 as the nominal body, and what else acts, friction and
contact alike, moves it s/(s + g) times as far. Late or sampled this does not hold: the loop of the
observer is g (M_n s + B_n)/(s (M s + B)), of crossover g M_n/M (`loop_gain` of the block "N_...").
Ohnishi, Shibata, Murakami, IEEE/ASME Trans. Mechatronics 1 (1996) 56, force in place of current.
"""

from __future__ import annotations

from dataclasses import replace

from ..base.errors import ModelError
from ..controllers import controller
from .junctions import Junction
from .parts import Control, Moving
from .wiring import Diagram


def disturbance_observer(
    diagram: Diagram,
    *,
    body: str,
    inertia: float,
    bandwidth: float,
    damping: float = 0.0,
) -> Diagram:
    """The diagram with a disturbance observer around a body, such as "Z_s".

    inertia, damping: M_n and B_n of the nominal body, kg and N s/m (kg m^2 and N m s/rad)
    bandwidth: cut-off g/(2 pi) of Q, Hz
    Blocks are "N_" and "Q_" with the body's name: nominal force and low-passed command. Signals are
    "F_N_", "F_Q_" and "d_": the estimate, positive along the motion, subtracted from the command.
    raises ModelError: no body of that name that forces move, or it has such an observer already
    """
    moving = diagram.block(body)
    if not isinstance(moving, Moving):
        raise ModelError(f"{diagram.name}: {body} is no body that forces move")
    if diagram.has(f"N_{body}"):
        raise ModelError(f"{diagram.name}: {body} has a disturbance observer already")
    nominal = controller(
        "nominal_inertia", {"inertia": inertia, "damping": damping, "bandwidth": bandwidth}
    )
    low_pass = controller("low_pass", {"bandwidth": bandwidth})
    command, estimate = moving.command, f"d_{body}"
    sums = {j.output: j for j in diagram.junctions}
    blocks = list(diagram.blocks)
    if command in sums:
        sums[command] = Junction(command, {**sums[command].terms, estimate: -1})
    else:  # a controller makes the command, or it comes from outside
        wanted, command = command, f"U_{body}"
        blocks = [replace(b, command=command) if b is moving else b for b in blocks]
        sums[command] = Junction(command, {wanted: 1, estimate: -1})
    sums[estimate] = Junction(estimate, {f"F_N_{body}": 1, f"F_Q_{body}": -1})
    motion = moving.motion
    added = {
        f"F_N_{body}": f"low-passed force that the nominal {body} takes",
        f"F_Q_{body}": f"low-passed command of {body}",
        estimate: f"force on {body} beside its command, as estimated",
    }
    return replace(
        diagram,
        blocks=(
            *blocks,
            Control(f"N_{body}", nominal, motion, f"F_N_{body}", motion),
            Control(f"Q_{body}", low_pass, command, f"F_Q_{body}"),
        ),
        junctions=tuple(sums.values()),
        measured=tuple(dict.fromkeys((*diagram.measured, motion))),
        texts={**diagram.texts, **added},
    )
