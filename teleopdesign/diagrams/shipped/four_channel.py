"""Lawrence's four channels: motion and force of each side go to the other, scaled and delayed.

    Z_m X_m = F_m - C_m X_m + C_2 K_2 e^(-s T_2) F_s + C_4 K_4 e^(-s T_4) X_s
    Z_s X_s = F_s - C_s X_s + C_1 K_1 e^(-s T_1) X_m + C_3 K_3 e^(-s T_3) F_m

    F_m = F_u - Z_H X_m        F_s = F_d - Z_E X_s

All forces act on master or slave, positive along its motion, as in `teleoperator`: F_s is what the
environment does to the slave, so that C_2 = C_3 = 1 reflects it, and C_4 > 0 pulls the master to
the slave (Lawrence writes -C_4). Without delay and scale C_1 = Z_s + C_s, C_4 = Z_m + C_m, C_2 =
C_3 = 1 make h_11 = h_22 = 0, h_21 = 1, h_12 = -1. Two channels, C_1 and C_4, are position-position
control, C_1 and C_2 position-force control. Lawrence, IEEE Trans. Robotics Autom. 9 (1993) 624.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...base.errors import ModelError
from ...blocks import Body
from ...controllers import Controller, controller
from ..parts import ANY, AnyBlock, Block, Control
from ..wiring import Diagram
from .teleoperator import TEXTS, teleoperator

#: channel -> what it carries, and the side that its controller pushes
CHANNELS = {"C_1": ("X_m", "s"), "C_2": ("F_s", "m"), "C_3": ("F_m", "s"), "C_4": ("X_s", "m")}
_OTHERS = {
    "F_Cm": "force of the master's own controller, subtracted",
    "F_Cs": "force of the slave's own controller, subtracted",
}
_CARRIED = {"X": "motion", "F": "force on it"}
_SIDES = {"m": "master", "s": "slave"}


def four_channel(
    master: Body | AnyBlock = ANY,
    slave: Body | AnyBlock = ANY,
    *,
    master_control: Controller | AnyBlock | None = ANY,
    slave_control: Controller | AnyBlock | None = ANY,
    channels: Mapping[str, Controller | AnyBlock] | None = None,
    delay: float | Mapping[str, float] = 0.0,
    position_scale: float = 1.0,
    force_scale: float = 1.0,
    hand: Body | AnyBlock | None = None,
    environment: Body | AnyBlock | None = None,
) -> Diagram:
    """Wire a teleoperator of up to four channels; the diagram has only the blocks that are stated.

    master, slave, hand, environment: as in `teleoperator`
    master_control, slave_control: C_m and C_s, from each side's motion, subtracted
    channels: "C_1" to "C_4", those that exist; default: all four. The law of a channel receives no
        velocity except that of its input (`proportional_derivative`, not `spring_damper`)
    delay: of every channel, or of each by name, s: delay blocks T_1 to T_4; no block if it is 0
    position_scale: X_s over X_m;  force_scale: force at the master over that at the slave: blocks
        K_1 = position_scale, K_4 = 1/K_1, K_2 = force_scale, K_3 = 1/K_2; no blocks if both are 1
    raises ModelError: a channel of another name, a scale that is not positive
    """
    laws = dict.fromkeys(CHANNELS, ANY) if channels is None else dict(channels)
    times = delay if isinstance(delay, Mapping) else dict.fromkeys(laws, delay)
    for name in (*laws, *times):
        if name not in laws or name not in CHANNELS:
            has = ", ".join(n for n in CHANNELS if n in laws)
            raise ModelError(f'four_channel: no channel "{name}", has {has}')
    scales = _scales(position_scale, force_scale)
    bare = teleoperator(master, slave, hand=hand, environment=environment).without("P")
    blocks: list[Block] = []
    commands: dict[str, dict[str, float]] = {"m": {}, "s": {}}
    for side, law in (("m", master_control), ("s", slave_control)):
        if law is not None:
            motion = f"X_{side}"
            blocks.append(Control(f"C_{side}", law, motion, f"F_C{side}", motion))
            commands[side][f"F_C{side}"] = -1
    for name in (n for n in CHANNELS if n in laws):
        source, side = CHANNELS[name]
        time = times.get(name, 0.0)
        blocks += _channel(name, laws[name], source, time=time, scale=scales.get(name))
        commands[side][f"F_{name.replace('_', '')}"] = 1
    sums = tuple(
        replace(j, terms=commands[j.output[-1]]) if j.output.startswith("U_") else j
        for j in bare.junctions
        if j.output != "X_e"
    )
    forces = [CHANNELS[n][0] for n in laws if n in ("C_2", "C_3")]
    diagram = replace(
        bare,
        name="four-channel teleoperator",
        blocks=(*bare.blocks, *blocks),
        junctions=sums,
        measured=("X_m", "X_s", *sorted(forces)),
    )
    return replace(diagram, texts=_texts(diagram))


def _scales(position: float, force: float) -> dict[str, float]:
    """Channel -> its scale; empty if both scales are 1."""
    if not (0 < position < float("inf") and 0 < force < float("inf")):
        raise ModelError(f"four_channel: found scales {position:g} and {force:g}, expected > 0")
    if position == force == 1:
        return {}
    return {"C_1": position, "C_2": force, "C_3": 1 / force, "C_4": 1 / position}


def _channel(
    name: str,
    law: Controller | AnyBlock,
    source: str,
    *,
    time: float,
    scale: float | None,
) -> list[Block]:
    """Scale, delay and controller of one channel, in this order."""
    number, blocks, signal = name[-1], list[Block](), source
    if scale is not None:
        made = controller("gain", {"gain": scale})
        blocks.append(Control(f"K_{number}", made, signal, f"{source}_scaled"))
        signal = f"{source}_scaled"
    if time:
        blocks.append(
            Control(f"T_{number}", controller("delay", {"time": time}), signal, f"{source}_late")
        )
        signal = f"{source}_late"
    return [*blocks, Control(name, law, signal, f"F_C{number}")]


def _texts(diagram: Diagram) -> dict[str, str]:
    texts = {n: _OTHERS.get(n, t) for n, t in TEXTS.items()}
    for name, (source, side) in CHANNELS.items():
        carried = f"{_CARRIED[source[0]]} of the {_SIDES[source[-1]]}".replace("on it of", "on")
        texts |= {
            f"F_{name.replace('_', '')}": f"force of channel {name} on the {_SIDES[side]}",
            f"{source}_scaled": f"{carried}, scaled",
            f"{source}_late": f"{carried}, as it arrives",
        }
    return {n: t for n, t in texts.items() if n in diagram.signals}


def diagram() -> Diagram:
    """The wiring with all optional blocks except scales, and 20 ms of delay in each channel."""
    return four_channel(hand=ANY, environment=ANY, delay=0.02)
