"""A nonlinear python-control system as a controller: code without a known equation.

The law calls the functions of the system. In a computer, an adaptive integrator advances a
continuous system over a sample with its input held; a discrete system is stepped without change.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy.utilities.lambdify import implemented_function

from ..base.errors import ModelError
from ..effects import SIGNALS as EFFECT_SIGNALS
from ..effects import Parameter
from ._controller import ControlLaw, Controller, ControllerState, Stage, mark_sampled_rate
from ._state_space import check_period

if TYPE_CHECKING:
    import control

#: tolerances, relative and in units of the states, of the integration of a system over a sample:
#: far below the resolution of the simulation around it, at some hundred calls a sample
_RELATIVE, _ABSOLUTE = 1e-10, 1e-13
#: number of random states at which a plant's output is compared with and without forces
_STATES = 5
#: beginning of the names of functions that generated source may call
_CALLED = "code_"
_numbers = count()
_Numbers = tuple[float, ...]
#: inputs and states that a law reads
_Read = tuple[tuple[sp.Expr, ...], tuple[sp.Expr, ...]]
_Reading = Callable[[Any], _Read]


def wrap_code(name: str, system: control.InputOutputSystem) -> Controller:
    """The system as a controller that simulations call and `to_iosystem` uses unchanged.

    raises ModelError: the system has dynamics, but states no number of states
    """
    made, n = _Laws(name, system), _order(name, system)

    def read(now: Any) -> _Read:
        return (now.input,), tuple(getattr(now, f"x_{i}") for i in range(n))

    states = {f"x_{i}": made.state(i, read) for i in range(n)}
    return made.controller(made.output(0, read), states)


def opaque_laws(
    name: str, system: control.InputOutputSystem, *, is_plant: bool = False
) -> tuple[list[Controller], list[Controller]]:
    """A system of several inputs as controllers: one for each state, one for each output.

    Each reads the first input, and as `others` the rest of the inputs, then all states.

    is_plant: inputs are forces and outputs positions, which no force moves at once: outputs are
        computed with zero force
    raises ModelError: as `wrap_code`; the system has no input; the output of a plant follows a
        force at once, at one of some states
    """
    made, n, m = _Laws(name, system), _order(name, system), int(system.ninputs or 0)
    if m < 1:
        raise ModelError(f"{name}: a system without inputs drives nothing: give it one")

    def read(now: Any) -> _Read:
        return (now.input, *now.others[: m - 1]), tuple(now.others[m - 1 :])

    def at_no_force(now: Any) -> _Read:
        return (sp.S.Zero,) * m, tuple(now.others[m - 1 :])

    if is_plant:
        _check_plant(name, made.calls, m, n)
    states = [made.controller(lambda now, p: now.x, {"x": made.state(i, read)}) for i in range(n)]
    shown = at_no_force if is_plant else read
    outputs = [made.controller(made.output(i, shown), {}) for i in range(int(system.noutputs))]
    return states, outputs


def _check_plant(name: str, calls: _Calls, m: int, n: int) -> None:
    for state in (0.0, *np.random.default_rng(1).uniform(-1, 1, (_STATES, n))):
        x = tuple(map(float, np.broadcast_to(state, n)))
        at = [calls.output(0.0, (u,) * m, x) for u in (0.0, 1.0, -1e3)]
        if any((a != at[0]).any() for a in at):
            raise ModelError(
                f"{name}: a position follows a force at once: a plant from force (N) to position "
                "(m) has a mass between them"
            )


def _order(name: str, system: control.InputOutputSystem) -> int:
    if system.nstates is None:
        raise ModelError(f"{name}: a nonlinear system with dynamics needs its number of states")
    return int(system.nstates)


class _Laws:
    """Laws that call the functions of a system with the inputs and states that they read."""

    def __init__(self, name: str, system: control.InputOutputSystem) -> None:
        self.name, self.system, self.calls = name, system, _Calls(system)
        self.discrete = bool(system.isdtime(strict=True))
        self.m = int(system.ninputs or 0)

    def output(self, i: int, read: _Reading) -> Callable[[Any, Any], sp.Expr]:
        calls, m = self.calls, self.m
        called = _function(f"output_{i}", lambda t, *z: calls.output(t, z[:m], z[m:])[i])

        def law(now: Any, p: Any) -> sp.Expr:
            inputs, states = read(now)
            return called(EFFECT_SIGNALS["time"], *inputs, *states)

        return law

    def state(self, i: int, read: _Reading) -> ControllerState:
        calls, m = self.calls, self.m
        change = _function(f"change_{i}", lambda t, *z: calls.change(t, z[:m], z[m:])[i])
        held = _function(f"held_{i}", lambda t, h, *z: calls.advance(t, z[:m], h, z[m:])[i])

        def changed(now: Any, p: Any) -> sp.Expr:
            inputs, states = read(now)
            return change(EFFECT_SIGNALS["time"], *inputs, *states)

        def carried(now: Any, p: Any) -> sp.Expr:
            inputs, states = read(now)
            return held(EFFECT_SIGNALS["time"], now.period, *inputs, *states)

        if self.discrete:
            return ControllerState("dimensionless", mark_sampled_rate, changed)
        return ControllerState("dimensionless", changed, carried)

    def controller(
        self, law: Callable[[Any, Any], sp.Expr], states: Mapping[str, ControllerState]
    ) -> Controller:
        name, discrete = self.name, self.discrete

        def sampled(values: Mapping[str, float], period: float) -> Stage:
            check_period(name, values["period"], period)
            return Stage(made, values)

        stated = float(self.system.dt) if discrete and self.system.dt is not True else 0.0
        made = ControlLaw(
            law=law,
            parameters={"period": Parameter("time", "of a sample; 0: any")} if discrete else {},
            states=states,
            sampled=sampled if discrete else None,
            system=self.system,
            source="python-control",
        )
        made = made.named(name, "A nonlinear python-control system.")
        return Controller((Stage(made, {"period": stated} if discrete else {}),))


def calls_in(expressions: list[sp.Expr]) -> dict[str, Callable[..., float]]:
    """Name in generated source -> function, for every function that the expressions call."""
    every = set().union(*(e.atoms(sp.core.function.AppliedUndef) for e in expressions))
    return {str(f.func): f.func._imp_ for f in every if is_call(f)}


def is_call(expression: sp.Expr) -> bool:
    """Whether an expression calls a function that is only code, without an equation."""
    return str(expression.func).startswith(_CALLED) and hasattr(expression.func, "_imp_")


def _function(what: str, called: Callable[..., float]) -> Callable[..., sp.Expr]:
    """The function as a sympy function, under a unique name."""
    symbol = sp.Function(f"{_CALLED}{next(_numbers)}_{what}", real=True)
    made: Callable[..., sp.Expr] = implemented_function(symbol, called)
    return made


class _Calls:
    """The functions of a system on plain numbers; the last result is kept for the other states."""

    def __init__(self, system: control.InputOutputSystem) -> None:
        self.system = system
        self.last: dict[str, tuple[Any, np.ndarray]] = {}

    def output(self, t: float, u: _Numbers, x: _Numbers) -> np.ndarray:
        return self._remember("output", (t, u, x), lambda: self._compute_output(t, x, u))

    def change(self, t: float, u: _Numbers, x: _Numbers) -> np.ndarray:
        """Rates of the states; in discrete time, the states at the next sample."""
        return self._remember("change", (t, u, x), lambda: self._compute_rates(t, x, u))

    def advance(self, t: float, u: _Numbers, period: float, x: _Numbers) -> np.ndarray:
        """States one period later, with the inputs held."""
        return self._remember("held", (t, u, period, x), lambda: self._integrate(t, u, period, x))

    def _remember(self, what: str, at: Any, call: Callable[[], np.ndarray]) -> np.ndarray:
        known = self.last.get(what)
        if known is None or known[0] != at:
            known = self.last[what] = (at, call())
        return known[1]

    def _compute_output(self, t: float, x: _Numbers, u: _Numbers) -> np.ndarray:
        answer = self.system.output(t, np.array(x, dtype=float), np.array(u, dtype=float))
        return np.asarray(answer, dtype=float).reshape(-1)

    def _compute_rates(self, t: float, x: Any, u: _Numbers) -> np.ndarray:
        rates = self.system.dynamics(t, np.array(x, dtype=float), np.array(u, dtype=float))
        return np.asarray(rates, dtype=float).reshape(-1)

    def _integrate(self, t: float, u: _Numbers, period: float, x: _Numbers) -> np.ndarray:
        from scipy.integrate import solve_ivp

        answer = solve_ivp(
            lambda now, y: self._compute_rates(now, y, u),
            (t, t + period),
            np.array(x, dtype=float),
            rtol=_RELATIVE,
            atol=_ABSOLUTE,
        )
        # what does not go on is no finite number, which the simulation names
        return np.asarray(answer.y[:, -1] if answer.success else np.full(len(x), np.nan))
