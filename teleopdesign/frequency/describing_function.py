"""Describing functions: the gain of a nonlinear law for the first harmonic of a sinusoidal motion.

N(A, omega) = phasor of the force over A, for the position A sin(omega t), computed from the law
itself by quadrature over a cycle. Closed forms for simple laws are in `closed_forms`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body, solve_carried_force
from ..controllers import SIGNALS as CONTROL_SIGNALS
from ..controllers import Controller, parameter_symbol
from ..effects import SIGNALS, delayed
from ..realise.simulated import without_absent
from .one_cycle import LawExpressions, first_harmonic, middles

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
    for part in _parts(sizes.size, 1 if law.rates else _AT_ONCE):
        motion = cycle_values(amplitudes[part], frequencies[part])
        signals = motion if isinstance(of, Body) else controller_signals(motion)
        if law.rates:
            signals = {symbol: values.reshape(-1) for symbol, values in signals.items()}
        coefficients[part] = first_harmonic(law, signals, frequency=frequencies[part].item(0))
    coefficients = (coefficients / sizes.reshape(-1)).reshape(sizes.shape)
    return coefficients if coefficients.shape else complex(coefficients)


def _parts(size: int, at_once: int) -> Iterator[slice]:
    return (slice(start, min(start + at_once, size)) for start in range(0, size, at_once))


def driven_gain(
    of: Controller, *, amplitude: float, frequency: float
) -> Callable[[complex], complex]:
    """Gain of a controller for the first harmonic of its input, while a motion goes on.

    amplitude, frequency: of that motion, which determines the speed in the controller
    returns: phasor of the input (1: in phase with position) -> complex gain. If the gain depends on
        speed, inputs of another phase have another gain; size matters only to nonlinear laws
    """
    law, motion, phase = controller_law(of), cycle_values(amplitude, frequency), middles()

    def gain(drive: complex) -> complex:
        signal = drive.real * np.sin(phase) + drive.imag * np.cos(phase)
        signals = controller_signals(motion) | {CONTROL_SIGNALS["input"]: signal}
        return complex(first_harmonic(law, signals, frequency=frequency)) / drive

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
