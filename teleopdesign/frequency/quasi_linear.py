"""The apparent impedance of an interface from describing functions instead of simulation.

Zhat_M = Gamma^-1 (Z_M - C) holds for linear blocks; here each nonlinear block is its describing
function at the amplitude of the motion. The input of a controller driven by a force is reduced to
its first harmonic. This is the approximation with which the simulation is compared.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping
from typing import Any

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..blocks import Body
from ..controllers import Controller
from ..derive import block_symbol, transfer
from ..derive.printing import dead_time_symbol, motion_controller_symbol
from ..diagrams import Control, Diagram
from ..realise.lti import S, linear_blocks, numerical
from .describing_function import LawExpressions, controller_law, describing_function, driven_gain

#: relative change at the end of the iteration for the phase of a controller's input; most
#: iterations
_CONVERGED, _MOST = 1e-9, 100


def quasi_linear(
    diagram: Diagram,
    output: str,
    source: str,
    given: str | tuple[str, ...],
    amplitude: float,
    frequency: np.ndarray,
    *,
    motion: str = "L",
) -> np.ndarray:
    """Response from one signal to another over frequency (Hz), while a motion has an amplitude.

    motion: the one along which nonlinear laws have their first harmonic, m or rad
    raises ModelError: a block without laws or without describing function
    """
    form = QuasiLinearForm(diagram, motion, output, source, given)
    return form.values(np.full(len(frequency), amplitude), frequency)


class QuasiLinearForm:
    """A transfer function into which blocks are inserted, each at the amplitude of a motion."""

    def __init__(
        self,
        diagram: Diagram,
        motion: str,
        output: str,
        source: str,
        given: str | tuple[str, ...],
    ) -> None:
        self.diagram, self.motion, self.source, self.given = diagram, motion, source, given
        self.force = self._transfer(output)
        self.compiled: dict[sp.Expr, Any] = {}
        self.moved = sp.S(1) if source == motion else self._transfer(motion)
        self.controls: dict[str, tuple[Controller, sp.Expr | None]] = {}
        self.linear = linear_blocks(diagram)
        for part in diagram.controls:
            if part.dead_time is not None:
                continue
            if part.name in self.linear.along:
                self._check_speed(part)
                continue
            if not isinstance(part.controller, Controller):
                raise ModelError(f"{diagram.name}: {part.name} is known by its name only, no laws")
            self.controls[part.name] = (part.controller, self._drive(part))

    def _check_speed(self, part: Control) -> None:
        """Raise ModelError if the linear form of a law on two signals changes with speed."""
        assert isinstance(part.controller, Controller)
        speed = sp.Symbol("speed", positive=True)
        forms = part.controller.linear_parts(part.name, S, speed) or ()
        if any(form.has(speed) for form in forms):
            raise ModelError(
                f"{self.diagram.name}: {part.name} follows {part.input} and the velocity of "
                f"{part.motion}, and its gain the speed: no describing function; simulate it"
            )

    def _drive(self, part: Control) -> sp.Expr | None:
        """Input of a controller per motion; None: the input is the motion itself."""
        if part.input == self.motion:
            return None
        return self._transfer(part.input) / self.moved

    def _transfer(self, output: str) -> sp.Expr:
        made = transfer(self.diagram, output, (self.source,), given=self.given)
        return sp.sympify(made[self.source])

    def values(self, amplitude: np.ndarray, frequency: np.ndarray) -> np.ndarray:
        """The transfer function at amplitudes (n,) of the motion and frequencies (n,), Hz."""
        s = 2j * np.pi * frequency
        of_s = {block_symbol(f"A_{n}"): e for n, e in self.linear.actuation.items()}
        for name, form in self.linear.along.items():
            of_s[motion_controller_symbol(name)] = form
            of_s[block_symbol(name)] = self.linear.blocks[name]
        made = {x: numerical(e)(s) for x, e in of_s.items()}
        times = {dead_time_symbol(n): float(t) for n, t in self.linear.dead_times.items()}
        made |= {x: np.full(len(s), t, dtype=complex) for x, t in times.items()} | {S: s}
        at = {"amplitude": amplitude, "frequency": frequency}
        for part in self.diagram.bodies:
            assert isinstance(part.body, Body)
            if part.motion != self.motion:
                raise ModelError(
                    f"{self.diagram.name}: {part.name} moves by {part.motion}, not by "
                    f"{self.motion}, and how far is not known: `measured_impedance` simulates it"
                )
            made[block_symbol(part.name)] = np.asarray(describing_function(part.body, **at))
        driven = {}
        for name, (law, drive) in self.controls.items():
            if drive is None:
                made[block_symbol(name)] = np.asarray(describing_function(law, **at))
            else:
                driven[name] = law, controller_law(law), drive
        points = zip(amplitude.tolist(), frequency.tolist(), strict=True)
        return np.array(
            [
                self._settle({x: complex(v[k]) for x, v in made.items()}, driven, *point)
                for k, point in enumerate(points)
            ]
        )

    def _settle(
        self,
        values: dict[sp.Symbol, complex],
        driven: Mapping[str, tuple[Controller, LawExpressions, sp.Expr]],
        amplitude: float,
        frequency: float,
    ) -> complex:
        """The value at one point, once the gains of the driven controllers have settled."""
        gains = []
        for name, (law, expressions, drive) in driven.items():
            gain = driven_gain(law, amplitude=amplitude, frequency=frequency, law=expressions)
            gains.append((block_symbol(name), gain, drive))
            values[block_symbol(name)] = 0j
        for _ in range(_MOST):
            before = dict(values)
            for symbol, gain, drive in gains:
                size = self._number(drive, values) * amplitude
                values[symbol] = gain(size) if size else 0j  # nothing drives it: no output
            if all(cmath.isclose(values[k], before[k], rel_tol=_CONVERGED) for k in values):
                return self._number(self.force, values)
        raise ModelError(f"{self.diagram.name}: the gains of its controllers settle on no phase")

    def _number(self, form: sp.Expr, values: dict[sp.Symbol, complex]) -> complex:
        if form not in self.compiled:
            used = tuple(sorted(form.free_symbols, key=str))
            self.compiled[form] = used, sp.lambdify(used, form, "cmath")
        used, call = self.compiled[form]
        return complex(call(*(values[x] for x in used)))
