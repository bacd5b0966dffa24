"""The apparent impedance of an interface from describing functions instead of simulation.

Zhat_M = Gamma^-1 (Z_M - C) holds for linear blocks; here each nonlinear block is its describing
function at the amplitude of the motion. The input of a controller driven by a force is reduced to
its first harmonic. This is the approximation with which the simulation is compared.
"""

from __future__ import annotations

import cmath
from collections.abc import Mapping, Sequence

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..base.units import unit_of
from ..blocks import Body
from ..controllers import Controller
from ..derive import block_symbol, transfer
from ..derive.printing import dead_time_symbol, motion_controller_symbol
from ..diagrams import Control, Diagram
from ..diagrams.units import first_axis
from ..realise.lti import S, linear_blocks
from .describing_function import describing_function, driven_gain
from .grid import Amplitude, Grid
from .impedance_map import ImpedanceMap
from .response import cases_of

#: relative change at the end of the iteration for the phase of a controller's input; most
#: iterations
_CONVERGED, _MOST = 1e-9, 100


def quasi_linear_impedance(
    diagrams: Diagram | Mapping[str, Diagram],
    *,
    amplitude: Amplitude,
    frequency: float | Sequence[float] | np.ndarray,
    motion: str = "L",
    force: str = "E",
) -> ImpedanceMap:
    """Impedance Zhat_M that a hand feels over frequency and amplitude, without simulation.

    Arguments are those of `measured_impedance`, with a prescribed motion; controllers are
    continuous.

    raises ModelError: a block without laws or without describing function
    """
    cases = cases_of(diagrams)
    grid = Grid.of(amplitude, frequency)
    z = np.empty((len(cases), *(len(getattr(grid, n)) for n in grid.dims)), dtype=complex)
    for i, diagram in enumerate(cases.values()):
        form = _Form(diagram, motion, force)
        for at, size, f in grid.points:
            z[(i, *at)] = form.value(size, f)
    axis = first_axis(next(iter(cases.values())))
    values = {"impedance": (z, unit_of("stiffness", axis))}
    data = grid.label(values, cases=list(cases), length=unit_of("position", axis))
    data.attrs |= {"motion": motion, "force": force}
    return ImpedanceMap(data)


class _Form:
    """The transfer function from motion to force, into which blocks are inserted."""

    def __init__(self, diagram: Diagram, motion: str, force: str) -> None:
        self.diagram, self.motion = diagram, motion
        self.force = transfer(diagram, force, (motion,), given=motion)[motion]
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
        transfers = transfer(self.diagram, part.input, (self.motion,), given=self.motion)
        return sp.sympify(transfers[self.motion])

    def value(self, amplitude: float, frequency: float) -> complex:
        s = 2j * np.pi * frequency
        values = {
            block_symbol(f"A_{n}"): complex(e.subs(S, s)) for n, e in self.linear.actuation.items()
        }
        for name, form in self.linear.along.items():
            values[motion_controller_symbol(name)] = complex(form.subs(S, s))
            values[block_symbol(name)] = complex(self.linear.blocks[name].subs(S, s))
        values |= {dead_time_symbol(n): complex(t) for n, t in self.linear.dead_times.items()}
        values[S] = s
        for part in self.diagram.bodies:
            assert isinstance(part.body, Body)
            if part.motion == self.motion:
                z = describing_function(part.body, amplitude=amplitude, frequency=frequency)
                values[block_symbol(part.name)] = complex(z)
        gains = []
        for name, (law, drive) in self.controls.items():
            values[block_symbol(name)] = 0j
            if drive is None:
                n = describing_function(law, amplitude=amplitude, frequency=frequency)
                values[block_symbol(name)] = complex(n)
            else:
                gain = driven_gain(law, amplitude=amplitude, frequency=frequency)
                gains.append((block_symbol(name), gain, drive))
        for _ in range(_MOST):
            before = dict(values)
            for symbol, gain, drive in gains:
                size = _number(drive, values) * amplitude
                values[symbol] = gain(size) if size else 0j  # nothing drives it: no output
            if all(cmath.isclose(values[k], before[k], rel_tol=_CONVERGED) for k in values):
                return _number(self.force, values)
        raise ModelError(f"{self.diagram.name}: the gains of its controllers settle on no phase")


def _number(form: sp.Expr, values: dict[sp.Symbol, complex]) -> complex:
    return complex(sp.N(sp.sympify(form).subs(values)))
