"""Passivity of one port with dead times: a wave that refutes it, or evidence over frequency.

Z(s) is a sum of rational functions, each with a dead time. The test is that of a two-port with Z at
both ports and no connection between the ports: both ports are passive, or neither is.
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

    returns: refuted by a growing wave; else evidence over frequency, poles and both ends of the
        axis looked at; unknown where the dead times lie within a loop, so that poles stay uncounted
    raises ModelError: no sum of late rational functions with numbers
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
