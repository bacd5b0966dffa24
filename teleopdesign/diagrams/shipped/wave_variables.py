"""A teleoperator whose sides exchange waves: the channel is passive for any constant delay.

    W_1 = 2 b v_m - W_2'       to the slave        W_2 = W_1' - 2 F_P      to the master
    F_c = b v_m - W_2'         on the master       b v_d = W_1' - F_P      asked of the slave

    Z_m X_m = F_m - F_c        Z_s X_s = F_s + F_P        F_P = P (b v_d - b v_s)

W' is the wave as it arrives, e^(-s T) W. So W_1 = b v_m + F_c and W_2 = b v_d - F_P: waves in N, as
Niemeyer and Slotine, IEEE J. Oceanic Eng. 16 (1991) 145, have them times (2 b)^(1/2), for which a
channel needs no square roots. The power F_c v_m - F_P v_d is what goes into it at both ends; of
that, (W^2)/(4 b) of each wave is on its way. P, on an error in N, is a damper B beside a spring K
as "proportional_integral" of gain B/b and rate K/B; with B = b no wave is sent back at once.
Waves that go to and fro leave positions alone: constant forces part them by F T/b.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ...base.errors import ModelError, unknown
from ...blocks import Body
from ...controllers import Controller, controller
from ..junctions import Junction
from ..parts import ANY, AnyBlock, Block, Control
from ..wiring import Diagram
from .teleoperator import TEXTS, teleoperator

_WAYS = ("T_1", "T_2")
_TEXTS = {
    "F_bm": "wave impedance times the velocity of the master",
    "F_bs": "wave impedance times the velocity of the slave",
    "F_c": "force of the channel on the master, subtracted",
    "F_P": "force of the slave's controller on the slave",
    "E": "wave impedance times the error of the slave's velocity",
    "W_1": "wave that leaves the master",
    "W_1_late": "that wave as it arrives at the slave",
    "W_2": "wave that leaves the slave",
    "W_2_late": "that wave as it arrives at the master",
}


def wave_variables(
    master: Body | AnyBlock = ANY,
    slave: Body | AnyBlock = ANY,
    *,
    wave_impedance: float | None = None,
    coupling: Controller | AnyBlock = ANY,
    delay: float | Mapping[str, float] = 0.0,
    hand: Body | AnyBlock | None = None,
    environment: Body | AnyBlock | None = None,
) -> Diagram:
    """Wire a teleoperator of wave variables.

    master, slave, hand, environment: as in `teleoperator`
    wave_impedance: b, N s/m, > 0, the same at both sides: blocks b_m and b_s; None: not known
    coupling: P, such as `controller("proportional_integral", ...)`
    delay: each way, s, or of "T_1" (to the slave) and "T_2" (to the master); no block if it is 0
    raises ModelError: a wave impedance that is not positive, a way of another name
    """
    if wave_impedance is not None and not 0 < wave_impedance < float("inf"):
        raise ModelError(f"wave_variables: found b = {wave_impedance:g} N s/m, expected > 0")
    times = delay if isinstance(delay, Mapping) else dict.fromkeys(_WAYS, delay)
    for name in times:
        if name not in _WAYS:
            raise ModelError(f"wave_variables: {unknown('way', name, _WAYS)}")
    damper: Controller | AnyBlock = ANY
    if wave_impedance is not None:
        damper = controller("spring_damper", {"stiffness": 0.0, "damping": wave_impedance})
    bare = teleoperator(master, slave, hand=hand, environment=environment).without("P")
    blocks: list[Block] = [
        Control("b_m", damper, "X_m", "F_bm", "X_m"),
        Control("b_s", damper, "X_s", "F_bs", "X_s"),
        Control("P", coupling, "E", "F_P"),
    ]
    sums = [j for j in bare.junctions if j.output in ("F_m", "F_s")]
    sums += [
        Junction("W_1", {"F_bm": 2, "W_2_late": -1}),
        Junction("F_c", {"F_bm": 1, "W_2_late": -1}),
        Junction("E", {"W_1_late": 1, "F_P": -1, "F_bs": -1}),
        Junction("W_2", {"W_1_late": 1, "F_P": -2}),
        Junction("U_m", {"F_c": -1}),
        Junction("U_s", {"F_P": 1}),
    ]
    for way, wave in zip(_WAYS, ("W_1", "W_2"), strict=True):
        if time := times.get(way, 0.0):
            late = controller("delay", {"time": time})
            blocks.append(Control(way, late, wave, f"{wave}_late"))
        else:
            sums.append(Junction(f"{wave}_late", {wave: 1}))
    diagram = replace(
        bare,
        name="teleoperator of wave variables",
        blocks=(*bare.blocks, *blocks),
        junctions=tuple(sums),
        measured=("X_m", "X_s"),
    )
    texts = {n: t for n, t in (TEXTS | _TEXTS).items() if n in diagram.signals}
    return replace(diagram, texts=texts)


def diagram() -> Diagram:
    """The wiring with every block that it can have, and 20 ms of delay each way."""
    return wave_variables(hand=ANY, environment=ANY, delay=0.02)
