"""How a computer knows velocity from sampled positions: source lines for the generated loop.

The observer is Luenberger's for a motion of constant velocity (order 2) or constant acceleration
(order 3), in its predictor-corrector form (alpha-beta and alpha-beta-gamma filters), all its poles
at one place p = `smoothing`. Its estimate is the derivative of the position through
    order 2: w^2/(s + w)^2, late by 2/w      order 3: (3 w^2 s + w^3)/(s + w)^3, late by nothing
for slow motion; the filtered difference goes through w/(s + w), late by 1/w.
"""

from __future__ import annotations


def gains(order: int) -> list[str]:
    """Lines that set the observer's gains, once; order 0: there is none."""
    if order == 0:
        return []
    velocity = "1.5 * (1.0 - smoothing) ** 2 * (1.0 + smoothing)"
    return [
        f"position_gain = 1.0 - smoothing**{order}",
        f"velocity_gain = ({velocity if order == 3 else '(1.0 - smoothing) ** 2'}) / period",
        "bend_gain = ((1.0 - smoothing) / period) ** 2 * (1.0 - smoothing)" if order == 3 else "",
    ]


def start(order: int, position: str, reading: str) -> list[str]:
    """Lines at the first sample, where the estimate is the true velocity."""
    bend = f"{position}_bend = 0.0" if order == 3 else ""
    return [f"{position}_observed = {reading}", bend] if order else []


def update(order: int, position: str, reading: str, rate: str, known: str) -> list[str]:
    """Lines at every other sample that bring `known`, the estimate, up to it."""
    if order == 0:
        return [f"{known} = smoothing * {known} + (1.0 - smoothing) * {rate}"]
    bend, observed = f"{position}_bend", f"{position}_observed"
    ahead = f"period * ({known} + 0.5 * period * {bend})" if order == 3 else f"period * {known}"
    return [
        f"{observed} += {ahead}",
        f"{known} += period * {bend}" if order == 3 else "",
        f"y = {reading} - {observed}",
        f"{observed} += position_gain * y",
        f"{known} += velocity_gain * y",
        f"{bend} += bend_gain * y" if order == 3 else "",
    ]
