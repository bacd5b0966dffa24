"""Response of several outputs to several inputs, from the equations with numbers inserted.

The symbolic forms of a diagram of many axes would be too long.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown
from ..derive import symbol_values
from ..derive.elimination import rows
from ..diagrams import Diagram
from ..realise.lti import linear_blocks, numerical
from ..realise.simulated import linear_parted
from .frozen_friction import cancellations_left_over, growing_modes

if TYPE_CHECKING:
    import control
    import xarray


@dataclass(frozen=True, eq=False)
class MatrixResponse(Shown, ByValue):
    """Response of several outputs to several inputs.

    data: complex, over frequency (Hz), output and input;  left_out: names without linear form
    left_over: controllers that cancel friction while friction is left out
    unstable: modes of the whole diagram that grow, in words; "": none, or not known
    """

    data: xarray.DataArray
    left_out: tuple[str, ...]
    left_over: tuple[str, ...] = ()
    unstable: str = ""

    def singular_values(self) -> np.ndarray:
        """Gains over all directions, (frequencies, min(outputs, inputs)), largest first."""
        return np.linalg.svd(self.data.values, compute_uv=False)

    def frd(self) -> control.FRD:
        """The response as a python-control frequency response."""
        from ..base import python_control as control

        values = np.moveaxis(self.data.values, 0, -1)
        return control.frd(values, 2 * np.pi * self.data["frequency"].values)


def matrix_response(
    diagram: Diagram,
    outputs: Sequence[str],
    inputs: Sequence[str],
    frequency: np.ndarray | Sequence[float],
    *,
    given: Sequence[str] = (),
    speed: float = 0.0,
) -> MatrixResponse:
    """Response of each output to each input, with all other inputs zero.

    frequency: (n,), Hz
    given: prescribed motions, in place of the forces that drive them; for a body with a compliant
        transmission, the motion of its tip
    speed: at which smoothed friction and schedules are frozen, m/s or rad/s
    raises ModelError: an unknown signal, an input that is not free, a loop without a solution
    """
    import xarray

    diagram, led = linear_parted(diagram, tuple(given))
    inputs, outputs = ([led.get(n, n) for n in names] for names in (inputs, outputs))
    given = list(led.values())
    drivers = {b.motion: b.driver for b in diagram.moving}
    free = [s for s in diagram.outside if s not in {drivers.get(m) for m in given}] + given
    for name in (*outputs, *inputs):
        diagram.signal(name)
    if bound := [name for name in inputs if name not in free]:
        raise ModelError(f'{diagram.name}: signal "{bound[0]}" is not from outside')
    unknown = [s for s in diagram.signals if s not in free]
    values = symbol_values(form := linear_blocks(diagram, speed=speed, held=True))
    s = 2j * np.pi * np.asarray(frequency, dtype=float)
    system = rows(diagram)
    matrix = np.zeros((len(s), len(system), len(unknown)), dtype=complex)
    right = np.zeros((len(s), len(system), len(inputs)), dtype=complex)
    for i, row in enumerate(system):
        for name, coefficient in row.items():
            target, names, sign = (right, inputs, -1) if name in inputs else (matrix, unknown, 1)
            if name in names:
                over = numerical(sp.sympify(coefficient).xreplace(values))
                target[:, i, names.index(name)] = sign * over(s)
    try:
        solved = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        raise ModelError(f"{diagram.name}: the wiring does not determine all signals") from None
    # a free signal responds to itself
    chosen = [
        solved[:, unknown.index(o)]
        if o in unknown
        else np.tile(np.array([complex(o == i) for i in inputs]), (len(s), 1))
        for o in outputs
    ]
    places = {
        "frequency": ("frequency", np.asarray(frequency), {"units": "Hz"}),
        "output": list(outputs),
        "input": list(inputs),
    }
    data = xarray.DataArray(np.stack(chosen, axis=1), places, (*places,))
    modes = "" if given else growing_modes(diagram, speed=speed) or ""
    cancelling = cancellations_left_over(diagram, form.left_out)
    return MatrixResponse(data, form.left_out, cancelling, modes)
