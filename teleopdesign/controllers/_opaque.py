"""A nonlinear python-control system as a controller: code, of which no equation is known."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._controller import ControlLaw, Controller, Stage

if TYPE_CHECKING:
    import control


def opaque(name: str, system: control.InputOutputSystem) -> Controller:
    """The system as a controller that only `to_iosystem` can use."""
    law = ControlLaw(law=_unknown, parameters={}, system=system, source="python-control")
    return Controller((Stage(law.named(name, "A nonlinear python-control system."), {}),))


def _unknown(now: Any, p: Any) -> Any:
    raise NotImplementedError
