"""What does it bring to cancel a device's inertia too, and what does delay cost?

Source: Bernstein, Lawrence, Pao, World Haptics 2005: C = Z_M is allowed there, with inertia, and
delay is blamed for limit cycles. P48 (`teleopdesign check-papers`): a late cancellation of inertia
gives out pi mhat A^2 omega^2 sin(omega tau), for omega tau < pi. Device and hands are examples.

Finding: without delay all of the inertia may go, and no more. A millisecond late, 1 % is refuted,
and any damping loses: omega sin(omega tau) has no bound. A low-pass of order r and bandwidth f_c
mends that, and then the delay hardly matters: the share r b/(2 pi f_c m) is passive whatever the
delay, exact for order 1, at most 1.4 times that for order 2. For 0.15 kg and 1 N s/m that is 21 %
at 10 Hz (order 2), which takes at most 18 % from the impedance felt, and 2.1 % at 100 Hz: inertia
can be cancelled for any hand only where the device's damping is felt anyway. In a computer of
period T, differences without low-pass allow 8 b T/(9 m), 0.6 %. With one hand that is known far
more is stable, and there delay costs: with a fingertip and 30 Hz 72 % at 0.5 ms, 47 % at 20 ms.
90 % would leave 0.15 of the impedance at 4 Hz. Beyond omega tau = pi the sign of P48 turns, as
simulated.

    python studies/cancellation_with_inertia_and_delay.py [--quick] [--output DIR]
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import _late_inertia as late
import matplotlib.figure
import numpy as np
import xarray
from _late_inertia_figure import draw
from _study import write_study

from teleopdesign.frequency import bode
from teleopdesign.passivity import (
    cancelled_inertia,
    damping_given_out,
    largest_passive_inertia,
    required_damping,
)

DELAY, LONG = 1e-3, 10e-3  # s
PERIOD = 1e-3  # s, of the sampled law
FREQUENCIES = np.geomspace(1.0, 1000.0, 301)  # Hz
DRIVEN = (20.0, 100.0, 250.0, 625.0)  # Hz; whole cycles in steps of 0.1 ms
FAST, SLOW = 1000.0, 30.0  # Hz, low-passes of panel (a)
BANDWIDTHS = np.geomspace(1.0, 1000.0, 61)  # Hz
DELAYS = np.linspace(0.5e-3, 20e-3, 40)  # s
#: hand that is known and bandwidth of the low-pass, Hz
KNOWN = tuple(product(late.HANDS, (30.0, 100.0)))
#: trials beside the limit: bandwidth (Hz) and delay (s) with any hand; delays (s) with known ones
ANY_HAND = ((5.0, DELAY), (30.0, DELAY), (30.0, LONG), (100.0, DELAY))
DELAYS_OF_CLAIMS = (2e-3, 8e-3, 16e-3)
BESIDE = (0.9, 1.1)  # share over its limit; growth and decay are then seen within seconds


@dataclass(frozen=True)
class LateInertia:
    """What a late, low-passed cancellation of inertia brings and costs.

    data: `released_energy` (N s/m), `felt` and `apparent_mass` (1) over frequency, `passive_share`
    over the low-pass's bandwidth, `stable_share` over delay, and simulated points beside them
    claims: sentence of each claim of passivity -> how it is settled
    """

    data: xarray.Dataset
    claims: dict[str, str]

    def plot(self) -> matplotlib.figure.Figure:
        return draw(self.data)

    def to_netcdf(self, path: Path) -> None:
        self.data.to_netcdf(path)

    def to_json(self, path: Path) -> None:
        content = {"claims": self.claims, "trials": self.data["rate"].to_dataframe().reset_index()}
        rows = content["trials"].to_dict("records")
        path.write_text(json.dumps({**content, "trials": rows}, indent=2) + "\n", encoding="utf-8")

    @property
    def as_expected(self) -> float:
        """Part of the trials that decay within the limit and grow beyond it."""
        grows = self.data["rate"] > 0
        return float((grows == (self.data["over_limit"] > 1)).mean())

    def __repr__(self) -> str:
        shown = self.data["passive_share"].sel(bandwidth=[1.0, 10.0, 100.0], method="nearest")
        lines = [f"Late inertia: {late.INERTIA:g} kg and {late.DAMPING:g} N s/m"]
        lines.append("  largest passive share, low-pass of 1, 10, 100 Hz")
        for law in shown["law"].values:
            row = " ".join(f"{x:7.4f}" for x in shown.sel(law=law).values)
            lines.append(f"    {law!s:<34} {row}")
        lines.append("  largest stable share with a known hand, about 1, 5, 20 ms late")
        known = self.data["stable_share"].sel(delay=[1e-3, 5e-3, 20e-3], method="nearest")
        for name in known["known"].values:
            row = " ".join(f"{x:7.4f}" for x in known.sel(known=name).values)
            lines.append(f"    {name!s:<34} {row}")
        count = self.data.sizes["trial"]
        lines.append(f"  {self.as_expected:.0%} of {count} simulations beside a limit agree")
        lines += [f"  {status}: {text}" for text, status in self.claims.items()]
        return "\n".join(lines)


def given_out() -> dict[str, xarray.DataArray]:
    """Negative damping of half the inertia cancelled: by formula and from simulated motion."""
    half = late.INERTIA / 2
    filters = {"no low-pass (P48)": 0.0, "fast": 1 / late.pole(FAST), "slow": 1 / late.pole(SLOW)}
    curves = [
        half * damping_given_out(FREQUENCIES, delay=DELAY, time_constant=t)
        for t in filters.values()
    ]
    simulated = [
        [late.simulated_damping(0.5, f, bandwidth=b, delay=DELAY) for f in DRIVEN]
        for b in (FAST, SLOW)
    ]
    unit = {"units": "N*s/m"}
    frequency = ("frequency", FREQUENCIES, {"units": "Hz"})
    return {
        "released_energy": xarray.DataArray(
            curves,
            {"filter": list(filters), "frequency": frequency},
            attrs=unit,
            dims=("filter", "frequency"),
        ),
        "given_out_simulated": xarray.DataArray(
            simulated,
            {"simulated_filter": ["fast", "slow"], "driven": ("driven", list(DRIVEN))},
            ("simulated_filter", "driven"),
            attrs=unit,
        ),
    }


def felt() -> dict[str, xarray.DataArray]:
    """What is felt in free space over what it is without cancellation: impedance, and mass alone.

    The apparent mass is the force in phase with acceleration, over acceleration.
    """
    cases = {"90 %, low-pass 30 Hz": (0.9, SLOW)}
    for bandwidth in (2.0, 10.0):
        share = passive_share(bandwidth)
        cases[f"{100 * share:.0f} %, low-pass {bandwidth:g} Hz, passive"] = (share, bandwidth)
    diagrams = {
        name: late.device(share, bandwidth=b, delay=DELAY) for name, (share, b) in cases.items()
    }
    diagrams["none"] = late.device(0.0, bandwidth=SLOW, delay=DELAY)
    frequency = FREQUENCIES / 10
    response = bode(diagrams, output="E", input="L", given="L", frequency=frequency).data
    response = response.rename({"frequency": "felt_frequency"})
    size, phase = response["magnitude"], np.radians(response["phase"])
    curves = {"felt": size, "apparent_mass": size * np.cos(phase)}
    return {
        name: (x.sel(case=list(cases)) / x.sel(case="none", drop=True)).assign_attrs(units="1")
        for name, x in curves.items()
    }


def passive_share(bandwidth: float, *, delay: float = DELAY, order: int = 2) -> float:
    """Largest share of the inertia for which the device is passive; bandwidth in Hz."""
    most = largest_passive_inertia(
        damping=late.DAMPING, delay=delay, time_constant=1 / late.pole(bandwidth), order=order
    )
    return most / late.INERTIA


def sampled_share(bandwidth: float) -> float:
    """The same for the law in a computer, by the exact discrete test; inf: no low-pass."""
    needed = required_damping(late.sampled_law(bandwidth, PERIOD), sample_time=PERIOD)
    return late.DAMPING / needed


def passive_shares(bandwidths: np.ndarray) -> xarray.DataArray:
    laws = {
        "order 1, any delay": [passive_share(b, order=1) for b in bandwidths],
        "order 2, 1 ms late": [passive_share(b) for b in bandwidths],
        "order 2, 10 ms late": [passive_share(b, delay=LONG) for b in bandwidths],
        "order 2, sampled at 1 kHz": [sampled_share(b) for b in bandwidths],
        "sampled, no low-pass": [sampled_share(np.inf)] * len(bandwidths),
    }
    return xarray.DataArray(
        list(laws.values()),
        {"law": list(laws), "bandwidth": ("bandwidth", bandwidths, {"units": "Hz"})},
        ("law", "bandwidth"),
        attrs={"units": "1"},
    )


def stable_shares(delays: np.ndarray) -> xarray.DataArray:
    """Largest stable share with known hands over delay."""
    shares = [
        [late.stable_share(late.HANDS[name], bandwidth=b, delay=t) for t in delays]
        for name, b in KNOWN
    ]
    names = [known_as(name, b) for name, b in KNOWN]
    return xarray.DataArray(
        shares,
        {"known": names, "delay": ("delay", delays, {"units": "s"})},
        ("known", "delay"),
        attrs={"units": "1"},
    )


def known_as(name: str, bandwidth: float) -> str:
    return f"{name}, low-pass {bandwidth:g} Hz"


def trials() -> xarray.Dataset:
    """Growth rate of simulated free motion just within and just beyond each limit."""
    rows = []
    for (bandwidth, delay), over in product(ANY_HAND, BESIDE):
        share = over * passive_share(bandwidth, delay=delay)
        rate = late.growth(share, bandwidth=bandwidth, delay=delay, hand=None)
        rows.append(("any", bandwidth, delay, share, over, rate))
    for (name, bandwidth), delay, over in product(KNOWN, DELAYS_OF_CLAIMS, BESIDE):
        hand = late.HANDS[name]
        share = over * late.stable_share(hand, bandwidth=bandwidth, delay=delay)
        rate = late.growth(share, bandwidth=bandwidth, delay=delay, hand=hand)
        rows.append((known_as(name, bandwidth), bandwidth, delay, share, over, rate))
    names = ("hand", "trial_bandwidth", "trial_delay", "share", "over_limit", "rate")
    columns = dict(zip(names, map(list, zip(*rows, strict=True)), strict=True))
    rate = columns.pop("rate")
    coordinates = {name: ("trial", values) for name, values in columns.items()}
    return xarray.Dataset({"rate": ("trial", rate, {"units": "1/s"})}, coordinates)


def claims() -> dict[str, str]:
    """Limits of the continuous law at 30 Hz and 1 ms, settled by the package."""
    low = {"delay": DELAY, "time_constant": round(1 / late.pole(SLOW), 6)}
    cases = [
        {"cancelled": late.INERTIA, "delay": 0},
        {"cancelled": 0.01 * late.INERTIA, "delay": DELAY},
        *({"cancelled": round(c * 1e-2, 6), **low, "order": 2} for c in (1.0, 1.1)),
    ]
    listed = [
        cancelled_inertia(inertia=late.INERTIA, damping=late.DAMPING, **values) for values in cases
    ]
    return {claim.statement: claim.status for claim in listed}


def run(*, quick: bool = False) -> LateInertia:
    """Everything; quick: fewer bandwidths and delays."""
    every = 6 if quick else 1
    beside = trials()
    data = xarray.Dataset(
        {
            **given_out(),
            **felt(),
            "passive_share": passive_shares(BANDWIDTHS[::every]),
            "stable_share": stable_shares(DELAYS[::every]),
        }
    )
    return LateInertia(data.merge(beside), claims())


def main() -> None:
    write_study(__file__, __doc__, run, quick="fewer bandwidths and delays")


if __name__ == "__main__":
    main()
