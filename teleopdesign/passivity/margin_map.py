"""Maps of the margins of a teleoperator over two of its values; numerical, no proof.

The impedance matrix is derived once, and then computed at each pair of values and each frequency,
with exact delays. If Llewellyn's margin is below zero, some pair of passive terminations makes the
teleoperator unstable. If the margin of passivity is below zero, a motion takes energy out. A margin
above zero proves nothing: frequencies between and beyond those of the grid, poles and residues are
not checked. `diagram_claims` judges a single point.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import sympy as sp

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..derive import symbol_values, two_port_functions
from ..diagrams import Diagram
from ..diagrams.units import unit_of_value
from ..realise.lti import LinearBlocks, S, linear_blocks, numerical
from ..realise.tips import linear_tips
from .two_port.two_port import passive_margin, stable_margin

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray

#: lowest and highest frequency, Hz, and their number: 40 a decade, because a resonance of 5 %
#: damping is 10 % wide
_FREQUENCY = (0.01, 1000.0, 201)


@dataclass(frozen=True, eq=False)
class MarginMap(Shown, ByValue):
    """Least margins over a grid of frequencies, at each pair of two values.

    data: `llewellyn` (dimensionless, -inf where a port alone is active), `passive` (N s/m), and
        `frequency` (Hz) of the least Llewellyn margin; dimensions are the names of the values
    left_out: names of the parts without a linear form
    """

    data: xarray.Dataset
    left_out: tuple[str, ...]

    def plot(self) -> matplotlib.figure.Figure:
        """Llewellyn's margin over both values, and the line where it is zero."""
        return figure_of(self)


@check_types
def margin_map(
    diagram: Diagram,
    values: Mapping[str, Sequence[float] | np.ndarray],
    *,
    frequency: np.ndarray | None = None,
    speed: float = 0.0,
) -> MarginMap:
    """Margins of absolute stability (Llewellyn) and of passivity (Raisbeck) over two values.

    Hand and environment are left out. Friction has no linear form: it is left out and named.

    diagram: a teleoperator with two sides
    values: two names of `diagram.values` -> numbers, of two different blocks
    frequency: Hz, (n,); default: 201 frequencies from 0.01 to 1000
    speed: m/s, at which smoothed friction and schedules are linearised
    raises ModelError: no two-port, not two names, an unknown name, two names of one block
    """
    import xarray

    if len(values) != 2 or len({name.partition(".")[0] for name in values}) != 2:
        raise ModelError(
            f"margin_map: expected values of two blocks, found {', '.join(values) or 'none'}"
        )
    f = np.geomspace(*_FREQUENCY) if frequency is None else np.asarray(frequency, dtype=float)
    device = linear_tips(diagram.without("Z_H", "Z_E"))
    matrix, s = _Matrix(device), 2j * np.pi * f
    base = linear_blocks(device, speed=speed)
    fixed = _responses(base, f)
    varied = [
        [_select_block(device.with_values({name: float(x)}), name, f, speed) for x in numbers]
        for name, numbers in values.items()
    ]
    shape = (len(varied[0]), len(varied[1]))
    margins = {name: np.empty(shape) for name in ("llewellyn", "passive", "frequency")}
    for i, first in enumerate(varied[0]):
        for k, second in enumerate(varied[1]):
            z = matrix(s, {**fixed, **first, **second})
            stable, passive = stable_margin(z), passive_margin(z)
            lowest = int(np.argmin(stable))
            margins["llewellyn"][i, k] = stable[lowest]
            margins["passive"][i, k] = passive.min()
            margins["frequency"][i, k] = f[lowest]
    units = {"llewellyn": "1", "passive": "N s/m", "frequency": "Hz"}
    names = list(values)
    varied_units = {n: unit_of_value(diagram, n) for n in names}
    data = xarray.Dataset(
        {n: (names, x, {"units": units[n]}) for n, x in margins.items()},
        {n: (n, np.asarray(values[n], dtype=float), {"units": varied_units[n]}) for n in names},
        {"diagram": diagram.name},
    )
    return MarginMap(data, base.left_out)


class _Matrix:
    """The derived impedance matrix, force over velocity, as a function of the blocks' responses."""

    def __init__(self, device: Diagram) -> None:
        functions = two_port_functions(device, convention="velocity")
        forms = [functions[f"Z_{i}{j}"] for i in "ms" for j in "ms"]
        used = set().union(*(e.free_symbols for e in forms)) - {S}
        # a block has a symbol that does not commute, a delay one that does: both by their names
        plain = {x: sp.Symbol(x.name) for x in used}
        self.names = sorted({x.name for x in used})
        arguments = [S, *(sp.Symbol(n) for n in self.names)]
        self.call = sp.lambdify(arguments, [e.xreplace(plain) for e in forms], "numpy")

    def __call__(self, s: np.ndarray, blocks: Mapping[str, np.ndarray]) -> np.ndarray:
        """Values at complex s (1/s), (n, 2, 2).

        blocks: name -> values of the block at each s, (n,); of a delay its time, s
        """
        entries = self.call(s, *(blocks[n] for n in self.names))
        flat = [np.broadcast_to(np.asarray(e, dtype=complex), s.shape) for e in entries]
        return np.stack(flat, axis=-1).reshape(*s.shape, 2, 2)


def _responses(linear: LinearBlocks, f: np.ndarray) -> dict[str, np.ndarray]:
    """Values of each symbol of the derivation over frequency (Hz), by its name, (n,)."""
    s = 2j * np.pi * f
    forms = {x.name: e for x, e in symbol_values(linear).items() if x.name not in linear.dead_times}
    responses = {n: numerical(sp.sympify(e))(s) for n, e in forms.items()}
    return responses | {n: np.full(len(f), float(t)) for n, t in linear.dead_times.items()}


def _select_block(device: Diagram, name: str, f: np.ndarray, speed: float) -> dict[str, np.ndarray]:
    """Responses over frequency of the block that has this parameter, by names of symbols.

    name: of the parameter, "block.parameter"
    """
    block = name.partition(".")[0]
    here = _responses(linear_blocks(device, speed=speed, only=block), f)
    return {n: x for n, x in here.items() if n in (block, f"A_{block}", f"V_{block}")}
