"""A measured frequency response as a controller: values at frequencies, without a law."""

from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.utilities.lambdify import implemented_function

from ..base.errors import ModelError
from ..effects import Parameter
from ._controller import ControlLaw, Controller, Stage

if TYPE_CHECKING:
    import control

#: relative distance from the axis that is the rounding of a point on the axis
_ROUNDING = 1e-9
#: the highest tenth of the frequencies determines the mass: enough of them that one outlier does
#: not count, and high enough that springs and dampers do not count
_OF_MASS = 10


def wrap_response(name: str, system: control.FrequencyResponseData) -> Controller:
    """The response as a controller that only frequency responses accept."""
    return _controller(name, *_points(name, system))


def measured_plant(name: str, system: control.FrequencyResponseData) -> tuple[float, Controller]:
    """A response from force (N) to position (m) as a mass (kg), and the force of the rest.

    1/P = m s^2 + R: m is the median over the highest tenth of the frequencies; R is exact at each
    frequency for any m.

    raises ModelError: no motion, or no mass at the highest frequencies
    """
    w, values = _points(name, system)
    if not values.all():
        raise ModelError(f"{name}: the plant stands still at a frequency, found a response of 0")
    last = slice(-max(len(w) // _OF_MASS, 1), None)
    mass = float(np.median(-(1 / values[last]).real / w[last] ** 2))
    if mass <= 0:
        raise ModelError(
            f"{name}: the highest frequencies show a mass of {mass:g} kg: measure beyond the "
            "resonances, from force (N) to position (m)"
        )
    return mass, _controller(name, w, 1 / values + mass * w**2)


def _points(name: str, system: control.FrequencyResponseData) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies (rad/s), sorted, and values at them."""
    w = np.asarray(system.frequency, dtype=float)
    values = np.asarray(system.frdata, dtype=complex).reshape(-1)
    order = np.argsort(w)
    w, values = w[order], values[order]
    if len(w) < 2 or w[0] <= 0 or not np.isfinite(values).all():
        raise ModelError(
            f"{name}: a frequency response needs two or more frequencies > 0 and finite values"
        )
    return w, values


def _controller(name: str, w: np.ndarray, values: np.ndarray) -> Controller:
    """A controller from values at frequencies, with linear interpolation between them."""

    def at(s: Any) -> np.ndarray:
        """Interpolate real and imaginary part linearly over the logarithm of frequency."""
        s = np.asarray(s, dtype=complex)
        asked_at = np.abs(s.imag)
        ends = asked_at.min(initial=np.inf), asked_at.max(initial=0.0)
        off_axis = np.abs(s.real) > _ROUNDING * np.abs(s)
        low, high = w[0] * (1 - _ROUNDING), w[-1] * (1 + _ROUNDING)
        if s.size and (off_axis.any() or ends[0] < low or ends[1] > high):
            raise ModelError(
                f"{name}: measured from {w[0]:.6g} to {w[-1]:.6g} rad/s on the axis, needed from "
                f"{ends[0]:.6g} to {ends[1]:.6g} rad/s{' and off it' if off_axis.any() else ''}"
            )
        x = np.log(asked_at)
        parts = (np.interp(x, np.log(w), part) for part in (values.real, values.imag))
        real, imaginary = parts
        return np.asarray(real + 1j * np.sign(s.imag) * imaginary)

    at.points = w  # type: ignore[attr-defined]
    mark = hashlib.sha256(w.tobytes() + values.tobytes()).hexdigest()[:16]
    law = ControlLaw(
        law=_unknown,
        parameters={"scale": Parameter("dimensionless", "times what was measured", lower=-np.inf)},
        response=implemented_function(sp.Function(f"measured_{mark}"), at),
        source="python-control",
    )
    text = f"A measured frequency response at {len(w)} frequencies."
    return Controller((Stage(law.named(name, text), {"scale": 1.0}),))


def measured_frequencies(expression: sp.Expr) -> tuple[np.ndarray, ...]:
    """Frequencies (rad/s), sorted, of each measured response in an expression."""
    calls = (f.func._imp_ for f in expression.atoms(AppliedUndef))
    return tuple(call.points for call in calls if hasattr(call, "points"))


def _unknown(now: Any, p: Any) -> Any:
    raise NotImplementedError
