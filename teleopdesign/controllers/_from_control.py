"""Any single-input, single-output system of python-control as a controller."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..errors import ModelError
from ..names import check_name
from . import _state_space
from ._controller import Controller
from ._opaque import opaque

if TYPE_CHECKING:
    import control


def from_control(system: control.InputOutputSystem, *, name: str = "state_space") -> Controller:
    """The system as a controller: block of a diagram, or a stage of one (`then`).

    system: transfer function or state space with one input and one output, proper. In continuous
        time its linear form is its transfer function, and a computer realises it exactly for an
        input held over each sample. In discrete time it is stepped as it is; the computer's period
        must be its own.
    name: in the names of parameters: "H.state_space.a_0_0"
    A nonlinear system (`control.nlsys`) is Python code: it takes part in `to_iosystem` alone.
    raises ModelError: several inputs or outputs, improper, measured frequency response, no system
    """
    import control

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
        raise ModelError(
            "from_control: a frequency response tells nothing of the steps in time: fit a transfer "
            "function to it"
        )
    if not isinstance(system, control.StateSpace | control.TransferFunction):
        if system.isdtime(strict=True):
            raise ModelError("from_control: a nonlinear system is taken in continuous time only")
        return opaque(name, system)
    if isinstance(system, control.TransferFunction) and _improper(system):
        raise ModelError(
            "from_control: the transfer function is improper, its numerator of higher order than "
            "its denominator: add a low-pass, such as 1/(tau s + 1)"
        )
    form = control.ss(system)
    period = None if not system.isdtime(strict=True) else 0.0 if form.dt is True else form.dt
    a, b, c = _scaled(form.A, form.B[:, 0], form.C[0])
    return Controller((_state_space.stage(name, (a, b, c, float(form.D[0, 0])), period),))


def inverted(system: control.LTI, *, bandwidth: float, name: str = "inverse") -> Controller:
    """The inverse of a transfer function with a low-pass of just enough roll-off to be proper.

    w(s) / T(s),   w(s) = (2 pi f_c / (s + 2 pi f_c))^r,   r: relative degree of T
    Given T = R_M / R_D of a compensated haptic interface and wired ahead of R_D, the hand feels w
    times the wanted force. Several axes: the same w for each makes every direction alike.

    bandwidth: f_c in Hz
    raises ModelError: T is zero or has a zero that is not in the left half-plane, discrete time
    """
    import control

    whole = control.tf(system)
    if whole.isdtime(strict=True) or (whole.ninputs, whole.noutputs) != (1, 1):
        raise ModelError("inverted: expected one input, one output and continuous time")
    above, below = (np.trim_zeros(x[0][0], "f") for x in (whole.num, whole.den))
    if not len(above):
        raise ModelError("inverted: the transfer function is zero")
    bad = [z for z in np.roots(above) if z.real >= 0]
    if bad:
        raise ModelError(
            f"inverted: the zero at s = {bad[0]:.4g} 1/s would be an unstable pole of the inverse"
        )
    pole = 2 * np.pi * bandwidth
    low = np.ones(1)
    for _ in range(len(below) - len(above)):
        low = np.convolve(low, [1 / pole, 1.0])
    return from_control(control.tf(below, np.convolve(above, low)), name=name)


def _scaled(
    a: np.ndarray, b: np.ndarray, c: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """States scaled by powers of two: the coefficients of a polynomial can span decades.

    A Butterworth low-pass of order 8 at 100 Hz loses 1e-8 of its step without, 3e-15 with it.
    """
    from scipy.linalg import matrix_balance

    if not len(b):
        return a, b, c
    balanced, (scale, _) = matrix_balance(a, permute=False, separate=True)
    return balanced, b / scale, c * scale


def _improper(system: control.TransferFunction) -> bool:
    above, below = (np.trim_zeros(x[0][0], "f") for x in (system.num, system.den))
    return len(above) > len(below)
