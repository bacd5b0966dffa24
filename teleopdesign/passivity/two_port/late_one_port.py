"""Passivity of a one-port with dead times: refuted by a wave, or supported over frequency.

Z(s) is a sum of rational functions, each with a dead time. The test is that of a two-port with Z at
both ports and no connection between the ports: then both ports are passive, or neither is.
"""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from ..claims.claim import Claim, Refutation, Unknown
from ..linear.impedance import readable
from ..search.growing_wave import GrowingWave, wave_of
from .claims import passive
from .two_port import two_port


def late_one_port(z: sp.Expr) -> Claim:
    """Is this impedance with dead times passive (force over velocity, in s and exp(-s T))?

    z: N s/m
    returns: refuted by a growing wave; else evidence over frequency, with poles and both ends of
        the axis checked; unknown where a dead time lies within a loop, because the poles are then
        not counted, or where a check fails and no wave is available
    raises ModelError: z is no expression in s with numbers and exp(-s T)
    """
    statement = f"Z(s) = {readable(z)} is passive at its port (force, velocity)"
    verdict = passive(two_port([[z, 0], [0, z]])).verdict
    if isinstance(verdict, Unknown):
        why = verdict.why.replace("z11 or z22", "Z").replace("z11", "Z")
        return Claim(statement, replace(verdict, why=why))
    if not isinstance(verdict, Refutation):
        return Claim(statement, verdict)
    pair = verdict.record
    assert isinstance(pair, GrowingWave)
    wave = wave_of(sp.ImmutableMatrix([[z]]), pair.rate, pair.frequency)
    if wave is None:
        return Claim(statement, Unknown("no wave that takes energy out was found"))
    return Claim(statement, Refutation(verdict.method, wave))
