"""Describing functions: the gain of a nonlinear law for the first harmonic of a sinusoidal motion.

N(A, omega) = phasor of the force over A, for the position A sin(omega t), computed from the law
itself by quadrature over a cycle. Closed forms for simple laws are in `closed_forms`.

A law along one cycle of a sinusoidal motion, with hidden states that repeat.

Rates that are affine in their state, A z + B, are integrated exactly over each step with A and B at
its middle (second order). The start from which a cycle closes follows from the decay of each state
over the cycle.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body, solve_carried_force
from ..controllers import SIGNALS as CONTROL_SIGNALS
from ..controllers import Controller, parameter_symbol
from ..effects import SIGNALS, delayed
from ..realise.simulated import without_absent
from .sinusoid import phasors

#: steps of a cycle. Forces are taken in the middle of each: no step lies on a reversal
STEPS = 2000
#: largest change of a state over a cycle, relative to its largest size, that counts as periodic;
#: and most cycles
_CLOSED, _MOST_CYCLES = 1e-9, 200
_Call = Callable[..., list[float]]


@dataclass(frozen=True)
class LawExpressions:
    """An output and its hidden states, as expressions of signals.

    rates: state -> its rate;  where: name of the law, in messages
    """

    output: sp.Expr
    rates: Mapping[sp.Symbol, sp.Expr]
    where: str

    @cached_property
    def force(self) -> tuple[tuple[sp.Symbol, ...], Callable[..., np.ndarray]]:
        """Symbols on which the output depends, and the output as a function of their arrays."""
        used = tuple(sorted(self.output.free_symbols, key=str))
        return used, sp.lambdify(used, self.output, "numpy", cse=True)

    @cached_property
    def steps(self) -> dict[tuple[sp.Symbol, ...], _Call]:
        """Slopes and rests of the states as a function of these signals, once they are compiled."""
        return {}


def first_harmonic(
    law: LawExpressions, signals: Mapping[sp.Symbol, np.ndarray], *, frequency: float | np.ndarray
) -> np.ndarray:
    """First harmonic of the law's output over a closed cycle, (...); sin is 1, cos is j.

    signals: symbol -> values (..., STEPS) in the middle of equal steps of one cycle from phase 0
    frequency: Hz, a number if the law has hidden states
    raises ModelError: the law needs another signal, or its states do not repeat
    """
    needed = law.output.free_symbols.union(*(r.free_symbols for r in law.rates.values()))
    if strangers := sorted(str(s) for s in needed - {*signals, *law.rates}):
        raise ModelError(
            f"{law.where}: no describing function, for it depends on {', '.join(strangers)}"
        )
    states = _close_cycle(law, signals, 1 / (float(frequency) * STEPS)) if law.rates else {}
    along = {**signals, **states}
    used, call = law.force
    with np.errstate(all="ignore"):  # a piecewise law is computed also where it does not hold
        force = np.asarray(call(*(along[s] for s in used)), dtype=float)
    if not np.isfinite(force).all():
        raise ModelError(f"{law.where}: the force is not finite along this motion")
    force = np.broadcast_to(force, np.broadcast_shapes(force.shape, (STEPS,)))
    # taken half a step after the nodes of `phasors`
    return np.asarray(phasors(force) * np.exp(-1j * np.pi / STEPS))


def middles() -> np.ndarray:
    """Phase omega t in the middle of each step of a cycle, (STEPS,)."""
    return 2 * np.pi * (np.arange(STEPS) + 0.5) / STEPS


def _close_cycle(
    law: LawExpressions, signals: Mapping[sp.Symbol, np.ndarray], step: float
) -> dict[sp.Symbol, np.ndarray]:
    """Hidden states in the middle of each step of a cycle that ends where it began."""
    states, read = [*law.rates], (*signals,)
    if read not in law.steps:
        law.steps[read] = _slopes_and_rest(law, [*signals])
    call = law.steps[read]
    rows = np.column_stack([*signals.values()]).tolist()
    start = np.zeros(len(states))
    for _ in range(_MOST_CYCLES):
        values, decay, end = _cycle(call, rows, start, step)
        size = np.maximum(np.abs(values).max(axis=0), np.finfo(float).tiny)
        if (np.abs(end - start) <= _CLOSED * size).all():
            return dict(zip(states, values.T, strict=True))
        # z -> decay z + c closes at c/(1 - decay); states that do not decay take their time
        kept = np.minimum(decay, 1 - 1e-9)
        start = start + (end - start) / (1 - kept)
    raise ModelError(f"{law.where}: hidden states do not repeat from cycle to cycle")


def _slopes_and_rest(law: LawExpressions, signals: list[sp.Symbol]) -> _Call:
    slopes = []
    for state, rate in law.rates.items():
        slope = sp.diff(rate, state)
        if slope.has(state):
            raise ModelError(
                f"{law.where}: no describing function, for {state} rests or slips by what it is "
                "itself: measure its impedance in simulation (`measured_impedance`)"
            )
        slopes.append(slope)
    rest = [rate.xreplace({state: sp.S(0)}) for state, rate in law.rates.items()]
    # plain numbers: arrays of one or two states would cost ten times as much
    function: _Call = sp.lambdify([*law.rates, *signals], [*slopes, *rest], "math", cse=True)
    return function


def _cycle(
    call: _Call, rows: list[list[float]], start: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States in the middle of the steps, decay of each initial state, and states at the end."""
    state = start.tolist()
    n = len(state)
    values, exponent = [], [0.0] * n
    for row in rows:
        derivatives = call(*state, *row)
        middle = [
            _advance(z, a, b, step / 2)
            for z, a, b in zip(state, derivatives, derivatives[n:], strict=False)
        ]
        derivatives = call(*middle, *row)
        state = [
            _advance(z, a, b, step)
            for z, a, b in zip(state, derivatives, derivatives[n:], strict=False)
        ]
        exponent = [e + a * step for e, a in zip(exponent, derivatives, strict=False)]
        values.append(middle)
    return np.array(values), np.exp(exponent), np.array(state)


def _advance(state: float, a: float, b: float, step: float) -> float:
    """The state after a step of its rate a z + b."""
    x = a * step
    share = 1 + x / 2 if abs(x) < 1e-8 else math.expm1(x) / x
    return state * math.exp(x) + step * share * b


#: points of a grid that are computed together, if no hidden state needs them one after another
_AT_ONCE = 100


def describing_function(
    of: Body | Controller,
    *,
    amplitude: float | np.ndarray,
    frequency: float | np.ndarray,
) -> complex | np.ndarray:
    """Impedance relative to position of a body, or of a controller driven by the motion, N/m.

    of: a body: the force that opposes its motion, from inertia and all effects except actuation,
        with a command of zero; a controller: its force
    amplitude: of the position, m or rad;  frequency: Hz; arrays are broadcast
    returns: complex, spring real, friction and damper +j, mass negative; in the shape of the grid
    raises ModelError: a law of the hand's force or of time, or states that never repeat
    """
    sizes, f = np.broadcast_arrays(np.asarray(amplitude, float), np.asarray(frequency, float))
    if not ((sizes > 0).all() and (f > 0).all()):
        raise ModelError("describing_function: amplitude and frequency must be positive")
    law = body_law(of) if isinstance(of, Body) else controller_law(of)
    amplitudes, frequencies = sizes.reshape(-1, 1), f.reshape(-1, 1)
    coefficients = np.empty(sizes.size, dtype=complex)
    at_once = 1 if law.rates else _AT_ONCE
    for part in (slice(start, start + at_once) for start in range(0, sizes.size, at_once)):
        motion = cycle_values(amplitudes[part], frequencies[part])
        signals = motion if isinstance(of, Body) else controller_signals(motion)
        if law.rates:
            signals = {symbol: values.reshape(-1) for symbol, values in signals.items()}
        coefficients[part] = first_harmonic(law, signals, frequency=frequencies[part].item(0))
    coefficients = (coefficients / sizes.reshape(-1)).reshape(sizes.shape)
    return coefficients if coefficients.shape else complex(coefficients)


def driven_gain(
    of: Controller, *, amplitude: float, frequency: float, law: LawExpressions | None = None
) -> Callable[[complex], complex]:
    """Gain of a controller for the first harmonic of its input, while a motion goes on.

    law: `controller_law` of the controller, for many calls
    amplitude, frequency: of that motion, which determines the speed in the controller
    returns: phasor of the input (1: in phase with position) -> complex gain. If the gain depends on
        speed, inputs of another phase have another gain; size matters only to nonlinear laws
    """
    expressions = law or controller_law(of)
    motion, phase = cycle_values(amplitude, frequency), middles()

    def gain(drive: complex) -> complex:
        signal = drive.real * np.sin(phase) + drive.imag * np.cos(phase)
        signals = controller_signals(motion) | {CONTROL_SIGNALS["input"]: signal}
        return complex(first_harmonic(expressions, signals, frequency=frequency)) / drive

    if not all(stage.law.linear for stage in of.stages):
        return gain
    # linear in its input: what it does to a sine and to a cosine says everything
    sine, cosine = gain(1.0 + 0j), gain(1j)
    return lambda drive: (sine + cosine + (sine - cosine) * drive.conjugate() / drive) / 2


def cycle_values(
    amplitude: float | np.ndarray, frequency: float | np.ndarray
) -> dict[sp.Symbol, np.ndarray]:
    """Position and its derivatives in the middle of each step of a cycle, with all forces zero.

    amplitude, frequency: numbers, or (m, 1);  returns: values (STEPS,) or (m, STEPS)
    """
    phase, omega = middles(), 2 * np.pi * frequency
    velocity = omega * amplitude * np.cos(phase)
    return {
        SIGNALS["position"]: amplitude * np.sin(phase),
        SIGNALS["velocity"]: velocity,
        SIGNALS["acceleration"]: -(omega**2) * amplitude * np.sin(phase),
        SIGNALS["direction"]: np.sign(velocity),
        SIGNALS["acting_force"]: np.zeros_like(velocity),
    }


def controller_signals(motion: Mapping[sp.Symbol, np.ndarray]) -> dict[sp.Symbol, np.ndarray]:
    """The signals of a controller whose input is the motion."""
    velocity = motion[SIGNALS["velocity"]]
    return {
        CONTROL_SIGNALS["input"]: motion[SIGNALS["position"]],
        CONTROL_SIGNALS["velocity"]: velocity,
        CONTROL_SIGNALS["speed"]: np.abs(velocity),
        CONTROL_SIGNALS["travel_rate"]: velocity,
    }


def body_law(body: Body) -> LawExpressions:
    """Force that opposes the motion of a body, with its values inserted."""
    body = without_absent(body)
    equation, numbers = solve_carried_force(body.equation(), body.effects), body.numbers()
    total = equation.inertia * SIGNALS["acceleration"] + equation.force + equation.friction
    rates = {s: r.subs(numbers) for s, r in equation.rates.items() if s not in equation.stages}
    return LawExpressions(total.subs(numbers), rates, "body")


def controller_law(of: Controller) -> LawExpressions:
    """Output of a controller, with its values inserted."""
    equation = of.equation("controller", {**CONTROL_SIGNALS, "period": sp.S(0)})
    numbers = {parameter_symbol("controller", n): v for n, v in of.names().items()}
    rates = {s: r.subs(numbers) for s, r in equation.rates.items()}
    names = ", ".join(stage.law.name for stage in of.stages)
    if any(e.has(delayed) for e in (equation.output, *equation.rates.values())):
        raise ModelError(f"describing_function: controller {names}: give the delay its own block")
    return LawExpressions(equation.output.subs(numbers), rates, f"controller {names}")
