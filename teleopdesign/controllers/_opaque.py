"""A nonlinear python-control system as a controller: code, of which no equation is known.

Its law calls the system's functions. In a computer a system in continuous time is carried over
a sample with its input held, by an adaptive integrator; one in discrete time is stepped as it is.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy.utilities.lambdify import implemented_function

from ..effects import SIGNALS as EFFECT_SIGNALS
from ..effects import Parameter
from ..errors import ModelError
from ._controller import ControlLaw, Controller, ControllerState, Stage, only_sampled
from ._state_space import check_period

if TYPE_CHECKING:
    import control

#: relative, and in the states' units; of a system carried over a sample: far below what the
#: simulation around it resolves, at some hundred calls a sample
_RELATIVE, _ABSOLUTE = 1e-10, 1e-13
#: begins the names of functions that generated source may call
_CALLED = "code_"
_numbers = count()


def opaque(name: str, system: control.InputOutputSystem) -> Controller:
    """The system as a controller, which simulations call and `to_iosystem` takes as it is.

    raises ModelError: the system has dynamics, and does not say how many states
    """
    if system.nstates is None:
        raise ModelError(f"{name}: a nonlinear system with dynamics needs its number of states")
    discrete = bool(system.isdtime(strict=True))
    calls, n = _Calls(system), int(system.nstates)
    output = _function("output", lambda t, u, *x: calls.output(t, u, x))

    def law(now: Any, p: Any) -> sp.Expr:
        return output(EFFECT_SIGNALS["time"], now.input, *_states(now, n))

    def state(i: int) -> ControllerState:
        change = _function(f"change_{i}", lambda t, u, *x: calls.change(t, u, x)[i])
        held = _function(f"held_{i}", lambda t, u, period, *x: calls.held(t, u, period, x)[i])

        def changed(now: Any, p: Any) -> sp.Expr:
            return change(EFFECT_SIGNALS["time"], now.input, *_states(now, n))

        def carried(now: Any, p: Any) -> sp.Expr:
            return held(EFFECT_SIGNALS["time"], now.input, now.period, *_states(now, n))

        if discrete:
            return ControllerState("dimensionless", only_sampled, changed)
        return ControllerState("dimensionless", changed, carried)

    def sampled(values: Mapping[str, float], period: float) -> Stage:
        check_period(name, values["period"], period)
        return Stage(made, values)

    stated = float(system.dt) if discrete and system.dt is not True else 0.0
    made = ControlLaw(
        law=law,
        parameters={"period": Parameter("time", "of a sample; 0: any")} if discrete else {},
        states={f"x_{i}": state(i) for i in range(n)},
        sampled=sampled if discrete else None,
        system=system,
        source="python-control",
    )
    made = made.named(name, "A nonlinear python-control system.")
    return Controller((Stage(made, {"period": stated} if discrete else {}),))


def calls_in(expressions: list[sp.Expr]) -> dict[str, Callable[..., float]]:
    """Name in generated source -> function, of every function that the expressions call."""
    every = set().union(*(e.atoms(sp.core.function.AppliedUndef) for e in expressions))
    return {str(f.func): f.func._imp_ for f in every if is_call(f)}


def is_call(expression: sp.Expr) -> bool:
    """Whether an expression calls a function that is known as code only, not as an equation."""
    return str(expression.func).startswith(_CALLED) and hasattr(expression.func, "_imp_")


def _function(what: str, called: Callable[..., float]) -> Callable[..., sp.Expr]:
    """The function as one of sympy, under a unique name."""
    symbol = sp.Function(f"{_CALLED}{next(_numbers)}_{what}", real=True)
    made: Callable[..., sp.Expr] = implemented_function(symbol, called)
    return made


def _states(now: Any, n: int) -> list[sp.Symbol]:
    return [getattr(now, f"x_{i}") for i in range(n)]


class _Calls:
    """The system's functions on plain numbers; equations ask for one state after the other."""

    def __init__(self, system: control.InputOutputSystem) -> None:
        self.system = system
        self.last: dict[str, tuple[Any, np.ndarray]] = {}

    def output(self, t: float, u: float, x: tuple[float, ...]) -> float:
        answer = self.system.output(t, np.array(x, dtype=float), np.array([u], dtype=float))
        return float(np.asarray(answer).reshape(-1)[0])

    def change(self, t: float, u: float, x: tuple[float, ...]) -> np.ndarray:
        """Rates, or states at the next sample of a system in discrete time."""
        return self._kept("change", (t, u, x), lambda: self._dynamics(t, np.array(x), u))

    def held(self, t: float, u: float, period: float, x: tuple[float, ...]) -> np.ndarray:
        """States a period later, the input held."""
        return self._kept("held", (t, u, period, x), lambda: self._carried(t, u, period, x))

    def _kept(self, what: str, at: Any, call: Callable[[], np.ndarray]) -> np.ndarray:
        known = self.last.get(what)
        if known is None or known[0] != at:
            known = self.last[what] = (at, call())
        return known[1]

    def _dynamics(self, t: float, x: np.ndarray, u: float) -> np.ndarray:
        inputs = np.array([u], dtype=float)
        return np.asarray(self.system.dynamics(t, x, inputs), dtype=float).reshape(-1)

    def _carried(self, t: float, u: float, period: float, x: tuple[float, ...]) -> np.ndarray:
        from scipy.integrate import solve_ivp

        answer = solve_ivp(
            lambda now, y: self._dynamics(now, y, u),
            (t, t + period),
            np.array(x, dtype=float),
            rtol=_RELATIVE,
            atol=_ABSOLUTE,
        )
        # what does not go on is no finite number, which the simulation names
        return np.asarray(answer.y[:, -1] if answer.success else np.full(len(x), np.nan))
