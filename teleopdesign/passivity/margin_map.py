"""Maps of the margins of a teleoperator over two of its values; numerical, no proof.

The equations of all states are solved at each pair of values and each frequency, with exact
delays. If Llewellyn's margin is below zero, some pair of passive terminations makes the
teleoperator unstable. If the margin of passivity is below zero, a motion takes energy out. A margin
above zero proves nothing: frequencies between and beyond those of the grid, poles and residues are
not checked. `diagram_claims` judges a single point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..base.arguments import check_types
from ..base.errors import ModelError
from ..base.frozen import ByValue
from ..base.shown import Shown, figure_of
from ..derive.all_states import AllStates, all_states
from ..derive.responses import Responses
from ..diagrams import Diagram
from ..diagrams.units import unit_of_value
from ..realise.lti import linear_blocks
from .intervals.box import ValueBox
from .intervals.linear import states_over
from .linear.family import port_rows
from .linear.sweep import passive_margin, stable_margin
from .ports import Port, ports, without_holders

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
    device = without_holders(diagram)
    if len(at := ports(device)) != 2:
        raise ModelError(f"{diagram.name}: no teleoperator: expected two ports, found {len(at)}")
    matrix = _impedance(device, at, values, speed)
    shape = tuple(len(numbers) for numbers in values.values())
    margins = {name: np.empty(shape) for name in ("llewellyn", "passive", "frequency")}
    for place in np.ndindex(*shape):
        point = [float(x[k]) for x, k in zip(values.values(), place, strict=True)]
        z = matrix(2j * np.pi * f, point)
        stable, passive = stable_margin(z), passive_margin(z)
        lowest = int(np.argmin(stable))
        margins["llewellyn"][place] = stable[lowest]
        margins["passive"][place] = passive.min()
        margins["frequency"][place] = f[lowest]
    units = {"llewellyn": "1", "passive": "N s/m", "frequency": "Hz"}
    names = list(values)
    varied_units = {n: unit_of_value(diagram, n) for n in names}
    data = xarray.Dataset(
        {n: (names, x, {"units": units[n]}) for n, x in margins.items()},
        {n: (n, np.asarray(values[n], dtype=float), {"units": varied_units[n]}) for n in names},
        {"diagram": diagram.name},
    )
    return MarginMap(data, linear_blocks(device, speed=speed).left_out)


def _impedance(
    device: Diagram,
    at: Sequence[Port],
    values: Mapping[str, Sequence[float] | np.ndarray],
    speed: float,
) -> Callable[[np.ndarray, Sequence[float]], np.ndarray]:
    """The impedance matrix, (n, 2, 2), as a function of s (1/s) and numbers for these values."""
    box = ValueBox.of({n: (float(np.min(x)), float(np.max(x))) for n, x in values.items()})
    known = states_over(device.with_values(box.named(box.centre)), box, speed)

    moved = [f"port {k}" for k in range(len(at))]

    def responses(states: AllStates) -> Responses:
        return Responses(states, [p.force for p in at], moved, port_rows(states, at, moved))

    shared = responses(known) if known else None

    def impedance(s: np.ndarray, point: Sequence[float]) -> np.ndarray:
        if shared:
            numbers = dict(zip(shared.states.ring.symbols[1:], point, strict=False))
            over_position = shared.at(s, numbers)
        else:
            there = device.with_values(dict(zip(values, point, strict=True)))
            over_position = responses(all_states(there, speed=speed)).at(s)
        return np.asarray(over_position / s[:, None, None])

    return impedance
