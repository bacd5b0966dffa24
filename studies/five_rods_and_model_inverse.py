"""Do five rods push alike in all directions, and what does a model inverse need for it?

Source: Bernstein, Lawrence, Pao, World Haptics 2005, equations (2) to (5), blocks being matrices;
the model inverse R_D = w T_H^-1 G^-T F_want is that of Lee, Lawrence, Pao (2004), as used there.
Machine and hand are examples (`_five_rods.py`); each rod has 0.5 N of Coulomb friction.

Finding: the friction of five equal rods is 0.54 to 1.86 N, by direction, and cancelling 90 % of
each rod's leaves a tenth of that. Without friction, singular values of the response spread by 6.3
up to 20 Hz, with force feedback by 2.6; the inverse brings every direction onto w, exactly. It
holds for the hand that it was made for: half as firm a hand brings a spread of 2.7 again. Simulated
with friction, 2 N wanted along one coordinate, the inverse alone changes nothing up to 2 Hz (1.33 N
rms in the worst coordinate at 2 Hz, 1.34 N without it); with force feedback and cancellation it
leaves 0.05 N there, and 0.09 N at 4 Hz, where both without inverse leave 0.60 N. From 10 Hz on,
what it leaves is the lag of w.

    python studies/five_rods_and_model_inverse.py [--quick] [--output DIR]
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import product
from pathlib import Path

import _five_rods as five
import matplotlib.figure
import numpy as np
import xarray
from _five_rods_figure import draw
from _study import write_study

from teleopdesign.diagrams import felt_friction
from teleopdesign.simulate import Simulation, simulate

WANTED = 2.0  # N, amplitude of the wanted force
BANDWIDTH = 200.0  # Hz, of both poles of w
FREQUENCIES = np.geomspace(0.1, 300.0, 141)  # Hz, of the responses
DRIVEN = (
    0.5,
    1.0,
    2.0,
    4.0,
    5.0,
    8.0,
    10.0,
    12.5,
    16.0,
    20.0,
)  # Hz; whole cycles in samples of 1 ms
QUICK = (1.0, 4.0, 10.0)
TRANSIENT = 0.6  # s; the slowest decay of hand and rods, 0.1 s, six times
#: compensation -> gain of the force feedback, share of the friction that is cancelled
COMPENSATIONS = {
    "none": (0.0, 0.0),
    "FF": (five.GAIN, 0.0),
    "hybrid": (five.GAIN, five.SHARE),
}
#: factors of stiffness and damping of hands that the inverse does not know of
OTHER_HANDS = (0.5, 2.0)
PLANE = (0, 1)  # coordinates of the hand in which friction is drawn: x, y


@dataclass(frozen=True)
class Isotropy:
    """What the hand gets of the force that was wanted.

    data: `singular_value` over (response, frequency, order), `error` (rms, N) over (compensation,
    inverse, coordinate, driven), `outline` and `friction` (N) in the plane of two coordinates
    felt: smallest and largest friction in any direction (N), before and after cancellation
    """

    data: xarray.Dataset
    felt: dict[str, tuple[float, float]]

    def band(self, response: str) -> float:
        """Largest over smallest singular value, the worst of all frequencies up to 20 Hz."""
        one = self.data["singular_value"].sel(response=response, frequency=slice(0, 20))
        return float((one.isel(order=0) / one.isel(order=-1)).max())

    def worst(self, compensation: str, *, inverse: bool) -> np.ndarray:
        """Error in the coordinate that has most, N rms, over the driven frequencies."""
        one = self.data["error"].sel(compensation=compensation, inverse=inverse)
        return np.asarray(one.max("coordinate").values)

    def plot(self) -> matplotlib.figure.Figure:
        return draw(self.data, self.felt)

    def to_netcdf(self, path: Path) -> None:
        self.data.to_netcdf(path)

    def to_json(self, path: Path) -> None:
        driven = [float(f) for f in self.data["driven"]]
        errors = {
            self._name(c, i): dict(zip(map(str, driven), self.worst(c, inverse=i), strict=True))
            for c, i in product(COMPENSATIONS, (False, True))
        }
        bands = {str(r): self.band(str(r)) for r in self.data["response"].values}
        content = {"felt_N": self.felt, "band_to_20_Hz": bands, "worst_rms_error_N": errors}
        path.write_text(json.dumps(content, indent=2) + "\n", encoding="utf-8")

    @staticmethod
    def _name(compensation: str, inverse: bool) -> str:
        return f"{compensation} + inverse" if inverse else compensation

    def __repr__(self) -> str:
        driven = " ".join(f"{f:>6g}" for f in self.data["driven"].values)
        lines = [
            f"  friction at the hand {case}: {least:.3f} to {most:.3f} N"
            for case, (least, most) in self.felt.items()
        ]
        lines += [
            f"  {r}: largest over smallest singular value up to 20 Hz {self.band(str(r)):.4g}"
            for r in self.data["response"].values
        ]
        lines.append(f"  rms error in the worst coordinate, N, at Hz   {driven}")
        for c, i in product(COMPENSATIONS, (False, True)):
            row = " ".join(f"{e:6.3f}" for e in self.worst(c, inverse=i))
            lines.append(f"    {self._name(c, i):<42}  {row}")
        return "\n".join(["Five rods and a model inverse", *lines])


def low_pass(frequency: np.ndarray) -> np.ndarray:
    """w at each frequency (Hz): two poles."""
    return 1 / (1 + 1j * frequency / BANDWIDTH) ** 2


def inverse(frequency: np.ndarray, gain: float) -> np.ndarray:
    """w T_H^-1 of the machine without friction, (frequencies, 5, 5)."""
    response = five.rod_response(frequency, gain=gain)
    return np.asarray(low_pass(frequency)[:, None, None] * np.linalg.inv(response))


def singular_values(frequency: np.ndarray) -> xarray.DataArray:
    """Of F_want -> G^T R_M, largest first: with and without inverse, and for unknown hands."""
    gains = {"no compensation": 0.0, "force feedback": five.GAIN}
    responses = {name: five.rod_response(frequency, gain=gain) for name, gain in gains.items()}
    ahead = inverse(frequency, five.GAIN)
    responses["inverse"] = responses["force feedback"] @ ahead
    for firmness in OTHER_HANDS:
        rods = five.rod_response(frequency, gain=five.GAIN, firmness=firmness)
        responses[f"inverse, hand x {firmness:g}"] = rods @ ahead
    values = [np.linalg.svd(five.at_hand(t), compute_uv=False) for t in responses.values()]
    return xarray.DataArray(
        np.array(values),
        {
            "response": list(responses),
            "frequency": ("frequency", frequency, {"units": "Hz"}),
            "order": np.arange(1, five.RODS + 1),
        },
        ("response", "frequency", "order"),
        attrs={"units": "1"},
    )


def driven(
    wanted: np.ndarray,
    frequency: float,
    *,
    gain: float,
    share: float,
    inverted: bool,
    **machine: bool,
) -> Simulation:
    """The machine while a sinusoid is wanted: settled, then at least half a second of cycles.

    wanted: amplitude in each coordinate of the hand (5,), N;  frequency: Hz
    inverted: R_D is that of the inverse, in its steady state
    """
    rods = np.linalg.solve(five.G.T, wanted).astype(complex)
    if inverted:
        rods = _inverse_at(frequency, gain) @ rods
    inputs = {f"R_D{n + 1}": partial(_sinusoid, r, frequency) for n, r in enumerate(rods)}
    cycles = np.ceil(TRANSIENT * frequency) + np.ceil(0.5 * frequency)
    return simulate(
        five.machine(gain=gain, share=share, **machine), duration=cycles / frequency, inputs=inputs
    )


@lru_cache
def _inverse_at(frequency: float, gain: float) -> np.ndarray:
    return inverse(np.array([frequency]), gain)[0]


def _sinusoid(phasor: complex, frequency: float, time: np.ndarray) -> np.ndarray:
    return np.imag(phasor * np.exp(2j * np.pi * frequency * time))


def last_cycles(
    simulation: Simulation, signal: str, frequency: float
) -> tuple[np.ndarray, np.ndarray]:
    """Time (n,) and the signals of all rods (n, 5) over the last whole cycles."""
    time = simulation.data["time"].values
    count = round(np.ceil(0.5 * frequency) / frequency / (time[1] - time[0]))
    rows = np.stack([simulation[signal.format(n + 1)].values for n in range(five.RODS)], axis=1)
    return time[-count - 1 : -1], rows[-count - 1 : -1]


def force_error(simulation: Simulation, wanted: np.ndarray, frequency: float) -> float:
    """Rms of G^T R_M - F_want over all coordinates, N."""
    time, rods = last_cycles(simulation, "R_M{}", frequency)
    error = rods @ five.G - np.sin(2 * np.pi * frequency * time)[:, None] * wanted
    return float(np.sqrt((error**2).sum(axis=1).mean()))


def errors(frequencies: tuple[float, ...]) -> xarray.DataArray:
    """Rms force error for every compensation, without and with inverse, in each coordinate."""
    axes = (tuple(COMPENSATIONS), (False, True), tuple(range(five.RODS)), frequencies)
    rows = []
    for compensation, inverted, k, f in product(*axes):
        gain, share = COMPENSATIONS[compensation]
        wanted = WANTED * np.eye(five.RODS)[k]
        simulation = driven(wanted, f, gain=gain, share=share, inverted=inverted)
        rows.append(force_error(simulation, wanted, f))
    names = ("compensation", "inverse", "coordinate", "driven")
    return xarray.DataArray(
        np.reshape(rows, [len(a) for a in axes]),
        {
            **dict(zip(names[:2], map(list, axes[:2]), strict=True)),
            "coordinate": list(five.COORDINATES),
            "driven": ("driven", list(frequencies), {"units": "Hz"}),
        },
        names,
        attrs={"units": "N", "wanted": WANTED / 2**0.5},
    )


def friction_at_hand(share: float) -> np.ndarray:
    """Friction less what is cancelled, as a force on the hand (n, 5), N.

    The wanted force turns in the plane that is drawn, once a second.
    """
    turning = np.zeros((2, five.RODS))
    turning[0, PLANE[0]] = turning[1, PLANE[1]] = 4 * WANTED
    rods = (turning[0] + 1j * turning[1]) @ np.linalg.inv(five.G)
    inputs = {f"R_D{n + 1}": partial(_sinusoid, r, 1.0) for n, r in enumerate(rods)}
    simulation = simulate(five.machine(share=share, gain=five.GAIN), duration=2.0, inputs=inputs)
    _, friction = last_cycles(simulation, "Z_M{}_friction", 1.0)
    _, cancelled = last_cycles(simulation, "R_MBC{}", 1.0)
    return np.asarray((cancelled - friction) @ five.G)


def run(*, quick: bool = False) -> Isotropy:
    """Responses, simulated errors and friction; quick: three driven frequencies."""
    levels = {"before": five.FRICTION, "after": (1 - five.SHARE) * five.FRICTION}
    felt = {name: felt_friction(five.G, [f] * five.RODS) for name, f in levels.items()}
    angle = np.radians(np.arange(0.0, 360.0, 0.5))
    around = np.zeros((len(angle), five.RODS))
    around[:, PLANE[0]], around[:, PLANE[1]] = np.cos(angle), np.sin(angle)
    case = {"case": list(felt)}
    plane = {"axis": [five.COORDINATES[k] for k in PLANE]}
    outlines = [f.force(around)[:, PLANE] for f in felt.values()]
    shown = [friction_at_hand(share)[:, PLANE] for share in (0.0, five.SHARE)]
    force = {"units": "N"}
    data = xarray.Dataset(
        {
            "singular_value": singular_values(FREQUENCIES),
            "error": errors(QUICK if quick else DRIVEN),
            "outline": (("case", "angle", "axis"), np.array(outlines), force),
            "friction": (("case", "sample", "axis"), np.array(shown), force),
        },
        {**case, **plane, "angle": ("angle", angle, {"units": "rad"})},
        {"wanted": f"sinusoid of {WANTED:g} N in one coordinate at a time"},
    )
    return Isotropy(data, {name: (f.smallest[0], f.largest[0]) for name, f in felt.items()})


def main() -> None:
    write_study(__file__, __doc__, run, quick="three driven frequencies")


if __name__ == "__main__":
    main()
