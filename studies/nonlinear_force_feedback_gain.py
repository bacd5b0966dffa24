"""How should the gain of force feedback fall with speed?

Source: Bernstein, Lawrence, Pao, "Friction modeling and compensation for haptic interfaces", World
Haptics 2005, feed the force error back with k b/(b + abs(v)) through a low-pass, and tune k, b and
the bandwidth by hand. Here: what each of them buys and costs. Residual friction is the force error
in motion at constant velocity, simulated; the delay margin that of the loop at rest, where its gain
is largest, with 0.5 kg in place of the hand; amplitude spread that of |Zhat_M| over 0.5 to 10 mm at
5 Hz.

Finding: k and the bandwidth alone set the delay margin, for large k about 1/(4 bandwidth k
m_H/(m + m_H)): 3.9 ms for k = 5 at 20 Hz, 1.1 ms for 15; k alone sets the friction at rest,
F_C/(1 + k): 0.083 and 0.031 N. b costs no margin, for the loop is most critical at rest. A larger b
halves the friction left at 10 mm/s (0.113 to 0.050 N for k = 5, b from 5 to 1000 mm/s); below
b = a k/(1 + k) = 12.5 mm/s (P13) slow motion feels more friction than rest. What it costs is
linearity: the amplitude spread grows from 10.1 to 13.5 dB, as large motion gets light too.
Bandwidth hardly moves the spread (0.5 dB at 5 Hz): where delay forbids more, k is worth more than
bandwidth, as far as friction at low frequency is all that matters.

    python studies/nonlinear_force_feedback_gain.py [--quick] [--output DIR]
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray
from _study import write_study

from teleopdesign.diagrams import Diagram, four_cases, read_open_number, world_haptics_2005
from teleopdesign.frequency import delay_margin, loop_gain, measured_impedance
from teleopdesign.show.figures.style import TWO_COLUMNS, house_style
from teleopdesign.show.frequency.impedance import logarithmic
from teleopdesign.simulate import Trajectory, simulate

if TYPE_CHECKING:
    import matplotlib.figure

SPEEDS = (1e-4, 0.01, 0.1)  # m/s; the first is rest, for it is far below every a and b
CASES = ("FF", "hybrid")
COLOURS = ("#56B4E9", "#0072B2", "#000000", "#D55E00", "#E69F00")


@dataclass(frozen=True)
class TradeOff:
    """What the choice of k, b and bandwidth buys and costs.

    data: `residual_friction` (N) over case, gain, scheduling_velocity and speed
        `delay_margin` (s) over gain_at_rest and bandwidth
        `spread` (dB) over case, gain, scheduling_velocity and bandwidth
    """

    data: xarray.Dataset

    def plot(self) -> matplotlib.figure.Figure:
        """Delay margin against gain, residual friction and amplitude spread against b."""
        import matplotlib.pyplot as plt

        with plt.style.context(house_style()):
            figure, axes = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.5))
            self._margin(axes[0])
            self._residual(axes[1])
            self._spread(axes[2])
            for axis in axes:
                axis.grid(True)
        return figure

    def _margin(self, axis: matplotlib.axes.Axes) -> None:
        from matplotlib.ticker import FuncFormatter

        margin = 1e3 * self.data["delay_margin"]
        for colour, f in zip(COLOURS, self.data["bandwidth"].values, strict=False):
            axis.plot(
                margin["gain_at_rest"], margin.sel(bandwidth=f), color=colour, label=f"{f:g} Hz"
            )
        axis.set_yscale("log")
        axis.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
        logarithmic(axis, float(margin["gain_at_rest"][0]), float(margin["gain_at_rest"][-1]))
        axis.set(xlabel="gain $k$ at rest (1)", ylabel="delay margin (ms)")
        axis.set_title("(a) low-pass of $H$", loc="left", pad=3)
        axis.legend()

    def _residual(self, axis: matplotlib.axes.Axes) -> None:
        friction = self.data["residual_friction"].sel(case="hybrid", speed=0.01)
        self._against_b(axis, friction)
        axis.set_ylabel("residual friction at 10 mm/s (N)")
        axis.set_title("(b) hybrid", loc="left", pad=3)

    def _spread(self, axis: matplotlib.axes.Axes) -> None:
        at = float(abs(self.data["bandwidth"] - read_open_number("bandwidth")).idxmin())
        self._against_b(axis, self.data["spread"].sel(case="hybrid", bandwidth=at))
        axis.set_ylabel(r"spread of $|\hat Z_M|$ (dB)")
        axis.set_title(f"(c) hybrid, {at:g} Hz", loc="left", pad=3)
        axis.legend(loc="lower right", ncols=2)

    def _against_b(self, axis: matplotlib.axes.Axes, values: xarray.DataArray) -> None:
        b = 1e3 * values["scheduling_velocity"]
        for colour, k in zip(COLOURS, values["gain"].values, strict=False):
            axis.plot(b, values.sel(gain=k), color=colour, label=f"$k$ = {k:g}")
        logarithmic(axis, float(b[0]), float(b[-1]))
        axis.set_ylim(bottom=0.0)
        axis.set_xlabel("scheduling velocity $b$ (mm/s)")

    def to_netcdf(self, path: Path) -> None:
        """Write everything with units."""
        self.data.to_netcdf(path)

    def to_json(self, path: Path) -> None:
        """Write everything as nested lists over named coordinates."""
        path.write_text(json.dumps(self.data.to_dict(), indent=1) + "\n", encoding="utf-8")

    def __repr__(self) -> str:
        d = self.data
        lines = [
            "Trade-off of the gain of force feedback",
            "  delay margin (ms), by gain (1) and bandwidth (Hz):",
        ]
        lines += [
            f"    {r}"
            for r in (1e3 * d["delay_margin"].to_pandas()).round(2).to_string().split("\n")
        ]
        for speed in d["speed"].values:
            lines.append(f"  hybrid: residual friction (N) at {1e3 * speed:g} mm/s:")
            table = d["residual_friction"].sel(case="hybrid", speed=speed).to_pandas().T
            lines += [f"    {row}" for row in table.round(3).to_string().split("\n")]
        return "\n".join(lines)


def at_constant_velocity(diagram: Diagram, speed: float) -> float:
    """Force error (N) once everything has settled in motion at that speed (m/s)."""
    motion = Trajectory(lambda t: speed * t, lambda t: speed + 0 * t, lambda t: 0 * t)
    # 0.35 s: 44 time constants of the low-pass of 20 Hz, and 350 bristle lengths at 0.1 mm/s
    simulation = simulate(
        diagram, duration=0.35, motion={"L": motion}, give=1e-7, computer="continuous", step=1e-3
    )
    return float(simulation["E"].values[-1])


def run(*, quick: bool = False) -> TradeOff:
    """All figures over k, b and bandwidth."""
    gains = np.array([2.0, 5.0, 15.0]) if quick else np.array([1.0, 2.0, 5.0, 15.0, 50.0])
    speeds = np.array([0.008, 0.08, 0.8]) if quick else np.geomspace(0.005, 1.0, 9)
    bandwidths = np.array([20.0]) if quick else np.array([5.0, 20.0, 80.0])
    rest = world_haptics_2005(position_loop=True).without("K", "C")
    shape = len(CASES), len(gains), len(speeds)
    friction = np.empty((*shape, len(SPEEDS)))
    spread = np.empty((*shape, len(bandwidths)))
    # from 1.5: below 1.3 the loop's gain is below 1 and bears any delay
    at_rest = np.geomspace(1.5, 50.0, 5 if quick else 25)
    margin = np.empty((len(at_rest), len(bandwidths)))
    for j, k in enumerate(at_rest):
        for n, bandwidth in enumerate(bandwidths):
            values = {"H.velocity_schedule.gain": k, "H.low_pass.bandwidth": bandwidth}
            margin[j, n] = delay_margin(loop_gain(rest.with_values(values)))
    four = four_cases(world_haptics_2005())
    for i, case in enumerate(CASES):
        for j, k in enumerate(gains):
            for m, b in enumerate(speeds):
                schedule = {"gain": k, "scheduling_velocity": b}
                values = {f"H.velocity_schedule.{n}": v for n, v in schedule.items()}
                diagram = four[case].with_values(values)
                friction[i, j, m] = [at_constant_velocity(diagram, v) for v in SPEEDS]
                for n, bandwidth in enumerate(bandwidths):
                    spread[i, j, m, n] = amplitude_spread(
                        diagram.with_values({"H.low_pass.bandwidth": bandwidth})
                    )
    return labelled(friction, margin, spread, gains, at_rest, speeds, bandwidths)


def amplitude_spread(diagram: Diagram) -> float:
    """Spread of |Zhat_M| (dB) over 0.5 to 10 mm at 5 Hz."""
    amplitude = 1e-3 * np.geomspace(0.5, 10.0, 6)
    impedance = measured_impedance(
        # a contact so soft moves sizes by 0.05 dB; the spread is 10 dB
        diagram,
        amplitude=amplitude,
        frequency=5.0,
        computer="continuous",
        give=1e-4,
    )
    return float(impedance.spread()["size"].item())


def labelled(
    friction: np.ndarray,
    margin: np.ndarray,
    spread: np.ndarray,
    gains: np.ndarray,
    at_rest: np.ndarray,
    speeds: np.ndarray,
    bandwidths: np.ndarray,
) -> TradeOff:
    """The figures with names and units."""
    over = ("case", "gain", "scheduling_velocity")
    return TradeOff(
        xarray.Dataset(
            {
                "residual_friction": ((*over, "speed"), friction, {"units": "N"}),
                "delay_margin": (("gain_at_rest", "bandwidth"), margin, {"units": "s"}),
                "spread": ((*over, "bandwidth"), spread, {"units": "dB"}),
            },
            {
                "case": list(CASES),
                "gain": ("gain", gains, {"units": "1"}),
                "gain_at_rest": ("gain_at_rest", at_rest, {"units": "1"}),
                "scheduling_velocity": ("scheduling_velocity", speeds, {"units": "m/s"}),
                "speed": ("speed", np.array(SPEEDS), {"units": "m/s"}),
                "bandwidth": ("bandwidth", bandwidths, {"units": "Hz"}),
            },
        )
    )


def main() -> None:
    write_study(__file__, __doc__, run, quick="a coarse grid")


if __name__ == "__main__":
    main()
