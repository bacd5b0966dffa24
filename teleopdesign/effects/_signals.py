"""Symbols in laws: signals of a body, parameters of an effect."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

import sympy as sp

from ..base.errors import ModelError


@cache
def parameter_symbol(effect: str, parameter: str) -> sp.Symbol:
    """Symbol of a parameter or state of an effect, by both names; other effects' laws can use it.

    One object for each pair of names: dictionaries find the same object without a comparison.
    """
    return sp.Symbol(f"{effect}_{parameter}", real=True)


#: symbols that a law may use; `direction` is sgn(velocity), `command` the input of an actuation
#: stage, `acting_force` the output of the last, `level` the friction level, `interaction_force`
#: the force of hand or environment on the body, `carried_force` the force that the transmission
#: hands on to inertia, forces of the place and hand, after damping and friction; `penetration` the
#: depth in a modelled environment
SIGNALS = {
    name: sp.Symbol(name, real=True)
    for name in (
        "time position velocity acceleration direction command acting_force interaction_force "
        "carried_force level penetration temperature other_position other_velocity "
        "other_acceleration".split()
    )
}
#: signal -> the additional channel of a record from which it comes; without the channel the signal
#: is not known
FURTHER = {
    "temperature": "temperature",
    "other_position": "other_position",
    "other_velocity": "other_position",
    "other_acceleration": "other_position",
}
#: further symbols for corrections: inertia of the effect's body, and the force that is left
#: unexplained along a measured motion
INERTIA, UNEXPLAINED = sp.symbols("inertia unexplained", real=True)
#: delayed(signal, delay): the signal a fixed time earlier
delayed = sp.Function("delayed", real=True)


def require_distinct(names: Iterable[str], where: str) -> None:
    """Refuse names that make one symbol, as "my.load_size" and "my_load.size", or that of a signal.

    raises ModelError: with the two
    """
    known = {signal: f"the signal {signal}" for signal in (*SIGNALS, "inertia", "unexplained")}
    for name in names:
        symbol = name.replace(".", "_")
        if symbol in known:
            both = f"{known[symbol]} and {name}"
            raise ModelError(f"{where}: {both} have one symbol: give one another name")
        known[symbol] = name
