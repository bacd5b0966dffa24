"""Any single-input, single-output system of python-control as a controller.

A measured frequency response is a controller with values at frequencies, and without a law.
"""

from __future__ import annotations

import hashlib
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.utilities.lambdify import implemented_function

from ..base.errors import ModelError, check_name
from ..base.recipes import remember
from ..effects import Parameter
from . import _state_space
from ._controller import ControlLaw, Controller, ControllerState, Stage, mark_sampled_rate
from ._law import store_input
from ._opaque import wrap_code
from ._state_space import Array

if TYPE_CHECKING:
    import control


def from_control(system: control.InputOutputSystem, *, name: str = "state_space") -> Controller:
    """The system as a controller: block of a diagram, or a stage of one (`then`).

    system: transfer function or state space with one input and one output, proper. In continuous
        time its linear form is its transfer function, and a computer realises it exactly for an
        input held over each sample. In discrete time it is stepped without change; the period of
        the computer must be its sample time.
    name: used in names of parameters: "H.state_space.numerator_0" of a transfer function, the
        coefficient of s^0, "H.state_space.a_0_0" of a state space
    The numbers are not rounded, so that poles and zeros that cancel on paper do cancel.
    A nonlinear system (`control.nlsys`) is Python code: it takes part in `simulate`, which then
    runs in plain Python, some hundred times slower, and in `to_iosystem`; claims and margins name
    it as left out, or refuse it. Over a sample with its input held, an adaptive integrator advances
    it to 1e-10; in discrete time it is stepped without change. A measured frequency response
    (`control.frd`) takes part only in `bode`, `loop_gain` and `matrix_response`, within its
    frequencies, by linear interpolation.
    raises ModelError: several inputs or outputs, improper, no system

        >>> import control as ct
        >>> td.from_control(ct.tf([1], [0.1, 1])).names()["state_space.denominator_1"]
        0.1
    """
    from ..base import python_control as control

    check_name(name, where="from_control")
    if not isinstance(system, control.InputOutputSystem):
        raise ModelError(
            f"from_control: expected a python-control system, found {type(system).__name__}"
        )
    if (system.ninputs, system.noutputs) != (1, 1):
        raise ModelError(
            f"from_control: expected one input and one output, found {system.ninputs} and "
            f"{system.noutputs}: a controller acts on one axis"
        )
    if isinstance(system, control.FrequencyResponseData):
        return wrap_response(name, system)
    if not isinstance(system, control.StateSpace | control.TransferFunction):
        return wrap_code(name, system)
    dt = system.dt
    period = None if not system.isdtime(strict=True) else 0.0 if dt is True else float(dt)
    if isinstance(system, control.TransferFunction):
        above, below = (np.trim_zeros(x[0][0], "f") for x in (system.num, system.den))
        if len(above) > len(below):
            raise ModelError(
                "from_control: the transfer function is improper, its numerator of higher order "
                "than its denominator: add a low-pass, such as 1/(tau s + 1)"
            )
        return Controller((_state_space.rational_stage(name, above, below, period),))
    matrices = system.A, system.B[:, 0], system.C[0], float(system.D[0, 0])
    return Controller((_state_space.stage(name, matrices, period),))


def unit_state(*, discrete: bool) -> Controller:
    """An integrator, or a delay of one sample: a single state without parameters."""
    return Controller((Stage(_state_law(discrete), {}),))


@lru_cache(maxsize=2)  # laws compare by identity
def _state_law(discrete: bool) -> ControlLaw:
    rate, step = (mark_sampled_rate, store_input) if discrete else (store_input, None)
    law = ControlLaw(
        law=lambda now, p: now.x,
        parameters={},
        states={"x": ControllerState("dimensionless", rate, step)},
        linear=not discrete,
        source="python-control",
    )
    return remember(law.named("state", "A state of a system."), _state_law, discrete)


def matrices_of(law: object) -> tuple[Array, Array, Array, float, float | None] | None:
    """A (n, n), B (n,), C (n,), D of a state space, unchanged, and its period (s) or None.

    None in place of all if the controller is no single system of matrices
    """
    stages = law.stages if isinstance(law, Controller) else ()
    values = stages[0].values if len(stages) == 1 else {}
    if not (len(stages) == 1 and _state_space.is_of_matrices(stages[0].law) and "d" in values):
        return None
    return (*_state_space.as_they_came(values), values.get("period"))


def invert_plant(system: control.LTI, *, bandwidth: float, name: str = "inverse") -> Controller:
    """The inverse of a transfer function, with a low-pass of just enough roll-off to be proper.

        w(s) / T(s),   w(s) = (2 pi f_c / (s + 2 pi f_c))^r,   r: relative degree of T

    If T = R_M / R_D is that of a compensated haptic interface, and the inverse is wired ahead of
    R_D, the hand feels w times the wanted force. With several axes, the same w on each makes all
    directions equal.

    bandwidth: f_c in Hz
    raises ModelError: T is zero or has a zero that is not in the left half-plane, discrete time
    """
    from ..base import python_control as control

    whole = control.tf(system)
    if whole.isdtime(strict=True) or (whole.ninputs, whole.noutputs) != (1, 1):
        raise ModelError("invert_plant: expected one input, one output and continuous time")
    above, below = (np.trim_zeros(x[0][0], "f") for x in (whole.num, whole.den))
    if not len(above):
        raise ModelError("invert_plant: the transfer function is zero")
    bad = [z for z in np.roots(above) if z.real >= 0]
    if bad:
        raise ModelError(
            f"invert_plant: the zero at s = {bad[0]:.4g} 1/s would be an unstable pole of the "
            "inverse"
        )
    pole = 2 * np.pi * bandwidth
    low = np.ones(1)
    for _ in range(len(below) - len(above)):
        low = np.convolve(low, [1 / pole, 1.0])
    return from_control(control.tf(below, np.convolve(above, low)), name=name)


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
