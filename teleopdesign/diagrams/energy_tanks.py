"""Energy tanks at both ends of a channel: no end releases energy that the other has not taken in.

    E_b = E_0 + arrived(taken at the other end) - given at b,   abs(U_b) <= E_b/d

At each end the computer counts what its force U_b has supplied to the body and what it has taken
from it, exactly, for it holds the force over each sample. What it has taken is sent to the other
end,
by any channel: a count that only grows is never too large where it is late, lost, or held. A force
within E_b/d takes no more than E_b out in a travel of d at most, so that no tank is ever overdrawn:

    given at both ends <= taken at both ends + 2 E_0           (theorem `energy_tank`)

That holds whatever the controllers and channels of the forces are. It needs: no sample's travel
above d, exact positions, forces that act as commanded, from their sample on, and counts that arrive
no larger than they were sent. Energies in and out apart, the one sent to the other end: Ryu,
Artigas, Preusche, Mechatronics 20 (2010) 812, with a damper where too much came out a sample ago;
tanks: Franken et al., IEEE Trans. Robotics 27 (2011) 741.
"""

from __future__ import annotations

from dataclasses import replace

from ..base.errors import ModelError
from ..controllers import Controller, controller
from .junctions import Junction
from .parts import Block, Control, Moving
from .wiring import Diagram

_TEXTS = {
    "wanted": "command before the tank limits it",
    "given": "energy that the command has given to the body",
    "taken": "energy that the command has taken from the body",
    "arrived": "energy taken at the other end, as it is known here",
    "tank": "energy in the tank beside its reserve",
    "limit": "largest command that cannot overdraw the tank",
}


def energy_tanks(
    diagram: Diagram,
    *,
    reserve: float,
    travel: float,
    ends: tuple[str, str] = ("Z_m", "Z_s"),
    to_first: Controller | None = None,
    to_second: Controller | None = None,
) -> Diagram:
    """The diagram with an energy tank before the actuators of two bodies.

    reserve: E_0, J, in each tank at the start;  travel: d, m or rad, largest travel of any sample
    ends: names of the bodies
    to_first, to_second: channels of the counts, such as a "delay" then a "lossy_hold": only delays,
        holds and losses; None: no delay
    Signals are "wanted_", "given_", "taken_", "arrived_", "tank_" and "limit_" with a body's name.
    raises ModelError: no such body that forces move, or it has a tank already
    """
    blocks, sums = list(diagram.blocks), list(diagram.junctions)
    texts, motions = dict(diagram.texts), []
    for name in ends:
        body = diagram.block(name)
        if not isinstance(body, Moving):
            raise ModelError(f"{diagram.name}: {name} is no body that forces move")
        if diagram.has(f"L_{name}"):
            raise ModelError(f"{diagram.name}: {name} has an energy tank already")
        command = body.command
        if any(j.output == command for j in sums):
            sums = [replace(j, output=f"wanted_{name}") if j.output == command else j for j in sums]
        else:  # a controller makes the command, or it comes from outside
            sums.append(Junction(f"wanted_{name}", {command: 1}))
            command = f"U_{name}"
            blocks = [replace(b, command=command) if b is body else b for b in blocks]
        blocks += _counters(name, command, body.motion)
        motions.append(body.motion)
        limit = controller("energy_limit", {"reserve": reserve, "travel": travel})
        limiter = _limit_parts(name, command, limit)
        blocks, sums = [*blocks, *limiter[0]], [*sums, *limiter[1]]
        texts |= {f"{start}_{name}": text for start, text in _TEXTS.items()}
    for name, other, channel in zip(ends, reversed(ends), (to_first, to_second), strict=True):
        if channel is None:
            sums.append(Junction(f"arrived_{name}", {f"taken_{other}": 1}))
        else:
            blocks.append(Control(f"E_{name}", channel, f"taken_{other}", f"arrived_{name}"))
    return replace(
        diagram,
        blocks=tuple(blocks),
        junctions=tuple(sums),
        measured=tuple(dict.fromkeys((*diagram.measured, *motions))),
        texts=texts,
    )


def _counters(name: str, command: str, motion: str) -> list[Block]:
    """Blocks that count the energy that a command supplies to the body, and takes from it."""
    return [
        Control(
            f"{letter}_{name}",
            controller("port_energy", {"sign": sign}),
            command,
            f"{count}_{name}",
            motion,
        )
        for letter, count, sign in (("G", "given", 1.0), ("K", "taken", -1.0))
    ]


def _limit_parts(name: str, command: str, limit: Controller) -> tuple[list[Block], list[Junction]]:
    """The wanted command w within the limit l: (abs(w + l) - abs(w - l))/2."""
    half = controller("magnitude", {"gain": 0.5})
    blocks: list[Block] = [
        Control(f"L_{name}", limit, f"tank_{name}", f"limit_{name}"),
        Control(f"A_{name}", half, f"above_{name}", f"above_half_{name}"),
        Control(f"B_{name}", half, f"below_{name}", f"below_half_{name}"),
    ]
    sums = [
        Junction(f"tank_{name}", {f"arrived_{name}": 1, f"given_{name}": -1}),
        Junction(f"above_{name}", {f"wanted_{name}": 1, f"limit_{name}": 1}),
        Junction(f"below_{name}", {f"wanted_{name}": 1, f"limit_{name}": -1}),
        Junction(command, {f"above_half_{name}": 1, f"below_half_{name}": -1}),
    ]
    return blocks, sums
