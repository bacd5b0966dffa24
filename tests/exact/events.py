"""Motion under laws that change at events, each event located: nothing here knows the package."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.integrate import solve_ivp

#: relative to each state, and absolute over the state's own size: rounding takes the rest
RELATIVE, ABSOLUTE = 1e-13, 1e-14
#: m or m/s by which a switch may be on the other side of its zero: rounding of what it is made from
BESIDE = 1e-12


def integrate(
    rate: Callable[[float, np.ndarray, tuple[int, ...]], Sequence[float]],
    switches: Sequence[Callable[[float, np.ndarray], float]],
    *,
    start: Sequence[float],
    mode: Sequence[int],
    times: np.ndarray,
    sizes: Sequence[float],
    longest: float = 1e-3,
) -> np.ndarray:
    """States (n, states) at `times`, from `start` at the first of them.

    rate(t, y, mode): smooth for one mode, the signs of the switches
    switches: functions of (t, y) at whose zeros the law changes;  mode: their signs at the start
    sizes: of the states, for the absolute tolerance
    longest: step, s; where two crossings fall into one, all is done again with shorter ones
    A step ends at each of the times: between its ends a fast bristle is known to 1e-6 only.
    """
    out = np.empty((len(times), len(start)))
    out[0], y, t, signs = start, np.asarray(start, dtype=float), float(times[0]), list(mode)
    at, step = 1, longest
    while at < len(times):
        solved = solve_ivp(
            lambda t, y, now=tuple(signs): rate(t, y, now),
            (t, float(times[at])),
            y,
            "DOP853",
            events=[_falling(switch, sign) for switch, sign in zip(switches, signs, strict=True)],
            rtol=RELATIVE,
            atol=ABSOLUTE * np.asarray(sizes),
            max_step=longest,
            first_step=min(step, float(times[at]) - t),
        )
        step = max(float(np.diff(solved.t).max()), 1e-6)  # an event may end a step where it begins
        hits = [(instants[0], i) for i, instants in enumerate(solved.t_events) if len(instants)]
        if hits:
            t, which = min(hits)
            y = solved.y_events[which][0]
            signs[which] = -signs[which]
        if not hits or t >= times[at]:
            t, y = float(times[at]), y if hits else solved.y[:, -1]
            out[at], at = y, at + 1
            sides = [n * g(t, y) for n, g in zip(signs, switches, strict=True)]
            if min(sides) < -BESIDE:
                options = {"start": start, "mode": mode, "times": times, "sizes": sizes}
                return integrate(rate, switches, **options, longest=longest / 8)
    return out


def _falling(switch: Callable[[float, np.ndarray], float], sign: int) -> Callable[..., float]:
    """The event that ends a mode: sign * switch falls through zero, not the zero it begins at."""

    def event(t: float, y: np.ndarray) -> float:
        return sign * switch(t, y)

    event.terminal = True  # type: ignore[attr-defined]
    event.direction = -1  # type: ignore[attr-defined]
    return event
