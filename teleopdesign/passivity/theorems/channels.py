"""Channels of a teleoperator that release no energy: wave variables, and energy tanks.

Wave variables are passive at both ends together, for slowly growing delays.
At the ends the waves are W_1 = b v_m + F_c and W_2 = b v_d - F_P. They arrive as f W_1(t - T_1) and
f W_2(t - T_2). The power into the channel is

    F_c v_m - F_P v_d = (W_1^2 - f^2 W_2(t - T_2)^2 + W_2^2 - f^2 W_1(t - T_1)^2)/(4 b)

The energy of the waves on their way is E = 1/(4 b) (integral of W_1^2 over t - T_1 to t, of W_2^2
over t - T_2 to t) >= 0. Its rate contains (1 - dT/dt) W(t - T)^2 for an arriving wave (Leibniz). So
the power is at least dE/dt where f^2 <= 1 - dT/dt, with waves at rest before the start.

For constant delays of any length, which may be unknown, f = 1 is sufficient (Niemeyer, Slotine,
IEEE J. Oceanic Eng. 16 (1991) 145). Delays that grow no faster than d need a scale below 1 (Lozano,
Chopra, Spong, Mechatronics 2002). The theorem does not cover waves that arrive at a jump of T, or
that are lost and replaced by others.

Energy tanks at the ends of a channel are never overdrawn, whatever the channel does. Before a
sample a tank contains W = E_0 + arrived - supplied. The held force f obeys abs(f) d <= W, and f = 0
where W < 0. Over a travel x with abs(x) <= d the tank supplies f x <= abs(f) d <= W. So the
supplied energy is never above E_0 plus the largest count that has arrived: late, in any order, held
or interpolated. A count only grows, so the count that has arrived is at most the energy that the
other end has taken by now. Summed over both ends: the energy that the computers supply to the
bodies, less the energy that they take from the bodies, is at most 2 E_0.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce

import sympy as sp

from ...base.errors import ModelError
from ...derive.all_states import all_states
from ...derive.polynomials import as_poly
from ...diagrams import Block, Diagram, wave_variables
from ...realise.lti import S, linear_blocks
from ..claims.claim import Claim, Proof, Unknown
from ..declarations import falsely_linear, is_shipped
from ..linear.impedance import decimal, exact, not_decaying
from ..linear.judge import positive_real
from ..ports import drop_absent_effects, without_holders
from ._hypotheses import Free, NonNegative, Positive, certificate, require_hypotheses


@require_hypotheses
def wave_channel(
    *, wave_impedance: Positive, scale: NonNegative = 1, delay_growth: NonNegative = 0
) -> Claim:
    """Is a channel of waves passive: does it release no more energy than came in at both ends?

    wave_impedance: b, N s/m;  scale: f, factor of arriving waves
    delay_growth: d, largest growth rate of a delay, s/s; delays are continuous, of any length
    returns: proved where f^2 <= 1 - d; else unknown, because no refuting motion is searched
    """
    b, f, d = wave_impedance, scale, delay_growth
    grows = f"grow by {decimal(d)} s a second at most" if d else "are constant or fall"
    statement = (
        f"a channel of waves of {decimal(b)} N s/m, scaled by {decimal(f)}, with delays that "
        f"{grows}, releases no more energy at both ends than came in, in continuous time"
    )
    if f**2 > 1 - d:
        return Claim(statement, Unknown("scale^2 is above 1 - delay_growth"))
    method = "the energy of the waves on their way, whose rate is at most the power that comes in"
    made = certificate("wave_channel", b=b, f=f, d=d)
    equality = "for constant delays: it is lossless" if f == 1 else ""
    return Claim(statement, Proof(method, (made,), float(1 - d - f**2), "", equality))


@require_hypotheses
def wave_teleoperator(
    *, master: Free, slave: Free, coupling: Free, wave_impedance: Positive
) -> Claim:
    """Is the teleoperator passive at hand and environment, for constant delays of any length?

    Energies add: F_m v_m + F_s v_s is the power into master, slave, controller and channel.

    master, slave: impedances, force over velocity, N s/m
    coupling: impedance of the slave's controller, from v_d - v_s to F_P, N s/m
    wave_impedance: b, N s/m
    returns: proved where each part is positive real; else unknown, for the whole may still be
        passive
    raises ModelError: an impedance that is not rational, or a wave impedance that is not > 0
    """
    channel = wave_channel(wave_impedance=wave_impedance)
    statement = (
        f"the teleoperator of waves of {decimal(wave_impedance)} N s/m is passive at both "
        "ports together, for all constant delays of its channel, in continuous time"
    )
    certificates = list(channel.certificates)
    for name, part in (("master", master), ("slave", slave), ("coupling", coupling)):
        claim = positive_real(part)
        if not isinstance(claim.verdict, Proof):
            return Claim(statement, Unknown(f"the {name} alone is not proved: {claim.statement}"))
        certificates += claim.certificates
    method = "energies of master, slave, the slave's controller and the channel, which add"
    return Claim(statement, Proof(method, tuple(certificates)))


def wave_claim(diagram: Diagram) -> Claim:
    """The claim `wave_teleoperator` for a diagram that is wired by `wave_variables`.

    Controllers are in continuous time. Hand and environment are left out. Coulomb friction may act
    in addition to the impedances, because its force opposes the velocity and dissipates energy.

    returns: unknown where some part is not in the impedances, or hides a growing mode
    raises ModelError: another wiring, a block without values, two wave impedances that differ, a
        slave's controller that is not linear
    """
    alone = without_holders(drop_absent_effects(diagram))
    wave_impedance = _wave_impedance(alone)
    linear = linear_blocks(alone)
    if "P" in linear.left_out:
        raise ModelError(f"{diagram.name}: P has no linear form")
    claim = wave_teleoperator(
        master=linear.blocks["Z_m"] / S,
        slave=linear.blocks["Z_s"] / S,
        coupling=exact(wave_impedance) * linear.blocks["P"],
        wave_impedance=wave_impedance,
    )
    opposing = {
        f"{b.name}.coulomb"
        for b in alone.bodies
        for effect in getattr(b.body, "effects", ())
        if effect.name == "coulomb" and is_shipped(effect)
    }
    bent = [n for n in (*linear.left_out, *falsely_linear(alone)) if n not in opposing]
    bent += [f"the actuator of {n}" for n, stage in linear.actuation.items() if stage != 1]
    # the channel acts on one side of a compliance, the hand on the other: two ports, not one
    bent += [
        f"{b.name}.{effect.name}"
        for b in alone.bodies
        for effect in getattr(b.body, "effects", ())
        if effect.role == "structure"
    ]
    bent = bent or [
        f"a mode within {part.name} that it does not show and that does not decay"
        for part in alone.blocks
        if _unseen_within(part)
    ]
    if bent and isinstance(claim.verdict, Proof):
        why = f"not in the impedances that were judged: {', '.join(bent)}"
        return Claim(claim.statement, Unknown(why))
    return claim


def _unseen_within(part: Block) -> tuple[complex, ...]:
    """Modes of a block with values that it does not show and that do not decay, 1/s."""
    driver = getattr(part, "driver", "")
    outside = dict.fromkeys((*part.inputs, *([driver] if driver else ())), "force")
    states = all_states(Diagram(part.name, (part,), (), outside, ()))
    d, n = states.solve(part.outputs, tuple(dict.fromkeys(part.inputs)))
    shared = reduce(lambda a, b: a.gcd(b), (e for row in n for e in row), d)
    is_late = any(any(k[1:]) for k in shared)
    return not_decaying(as_poly(shared, S)) if d and not is_late else ()


def _wave_impedance(diagram: Diagram) -> float:
    """Wave impedance b of a diagram without hand and environment, wired by `wave_variables`.

    raises ModelError: another wiring
    """
    bodies = {b.name: b.body for b in diagram.moving}
    controls = {c.name: replace(c, analog=False) for c in diagram.controls}
    impedance = 0.0
    if "b_m" in controls:  # its linear form is to be b s
        linear = linear_blocks(diagram, only="b_m")
        damping = sp.cancel(linear.blocks["b_m"] / S)
        is_damper = "b_m" not in linear.left_out and not damping.free_symbols
        impedance = float(damping) if is_damper else 0.0
    if {"Z_m", "Z_s"} <= set(bodies) and "P" in controls and impedance > 0:
        made = wave_variables(
            bodies["Z_m"],
            bodies["Z_s"],
            wave_impedance=impedance,
            coupling=controls["P"].controller,
            delay={n: controls[n].dead_time or 0.0 for n in ("T_1", "T_2") if n in controls},
        )
        blocks = tuple(controls.get(b.name, b) for b in diagram.blocks)
        if replace(diagram, name=made.name, texts=made.texts, blocks=blocks) == made:
            return impedance
    raise ModelError(
        f"{diagram.name}: not wired as `wave_variables` does it, with one b on both sides"
    )


@require_hypotheses
def energy_tank(*, reserve: NonNegative, travel: Positive) -> Claim:
    """Bound of the energy that two ends with energy tanks (`energy_tanks`) release.

    reserve: E_0 in each tank, J;  travel: d, largest travel of any sample, m or rad
    returns: proved, if positions are exact, forces act as commanded and from their sample on, and
        counts of energy arrive no larger than they were sent; they may be late, jittered, lost or
        held
    """
    statement = (
        f"two ends with energy tanks of {decimal(reserve)} J give their bodies at most "
        f"{decimal(2 * reserve)} J more than they take from them, as long as no sample's travel "
        f"exceeds {decimal(travel)} m, positions are exact and commands act from their sample on"
    )
    method = "what a held force gives over the largest travel, and counts that only grow"
    force = reserve / travel
    made = certificate("energy_tank", W=reserve, F=force, f=force, d=travel)
    return Claim(statement, Proof(method, (made,), equality="at the largest travel"))
