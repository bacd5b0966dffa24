"""How much friction may be cancelled before a slave swings, and what does that depend on?

Source: the docs page "A robustness study for a paper" at full size. The theorem f_D <= f_C is P37
of Mahvash, Okamura, ICRA 2006; the diagram is docs/examples/swing.toml.

Each point of the map and each point of the Sobol indices is a simulation of 0.6 s, from rest at
5 mm with the master held, controllers in continuous time.

Finding: none of 704 points within the proved region grows. Above it, of the variance of the growth
over the four ranges, the coupling's damping causes 0.29 alone, the cancelled level 0.20, the law's
bristle 0.19 and the environment 0.01.

    python studies/robustness_for_a_paper.py [--quick] [--output DIR]
"""

from __future__ import annotations

from pathlib import Path

import matplotlib.figure
import numpy as np
import xarray
from _study import write_study

import teleopdesign as td
from teleopdesign.passivity import dahl_compensation
from teleopdesign.studies import Study

DIAGRAM = Path(__file__).parents[1] / "docs" / "examples" / "swing.toml"
LEVEL, DAMPING = "C_s.dahl.level", "P.spring_damper.damping"
RANGES = {
    LEVEL: (0.5, 3.0),
    DAMPING: (0.1, 5.0),
    "Z_E.spring.stiffness": (0.0, 4000.0),
    "C_s.dahl.stiffness": (300.0, 3000.0),
}
LABELS = {
    LEVEL: "cancelled friction $f_D$",
    DAMPING: "damping of the coupling $D$",
    "Z_E.spring.stiffness": "environment $k_e$",
    "C_s.dahl.stiffness": r"bristle of the law $\sigma_D$",
}


def run(*, quick: bool = False) -> tuple[Study, Study, float]:
    """The map, the points for the indices, and the largest level that is proved passive, N."""
    diagram = td.read_diagram(DIAGRAM)
    n, base = (12, 16) if quick else (64, 1024)
    plane = {LEVEL: np.linspace(0.5, 3.5, n), DAMPING: np.geomspace(0.1, 5.0, n)}
    grid, drawn = (
        td.study(
            diagram,
            axes,
            measures={"growth": td.measure("growth", signal="X_s")},
            labels=LABELS,
            duration=0.6,
            initial={"X_s": 5e-3},
            motion={"X_m": td.sine(amplitude=0.0, frequency=1.0)},
            computer="continuous",
        )
        for axes in (plane, td.sensitivity_samples(RANGES, base, seed=1))
    )
    friction, bristle = diagram.values["Z_s.coulomb.level"], diagram.values["C_s.dahl.stiffness"]
    claim = dahl_compensation(
        coulomb_level=friction, compensator_level=friction, compensator_stiffness=bristle
    )
    return grid, drawn, friction if claim.status == "proved" else float("nan")


def summary(result: tuple[Study, Study, float]) -> str:
    """How many simulations, and whether any of them grows where it is proved passive."""
    grid, drawn, limit = result
    within = grid["growth"].sel({LEVEL: slice(None, limit)})
    failed = sum(grid.failures.values()) + sum(drawn.failures.values())
    first = drawn.sensitivity()["first"]
    listed = ", ".join(
        f"{float(v):.2f} {p}" for p, v in zip(first["parameter"].values, first, strict=True)
    )
    return (
        f"{grid['growth'].size + drawn['growth'].size} simulations, {failed} failed; "
        f"{int((within > 0).sum())} of {within.size} grow at f_D <= {limit:.3g} N; shares of the "
        f"variance alone: {listed}"
    )


def figures(result: tuple[Study, Study, float]) -> dict[str, matplotlib.figure.Figure]:
    """The map and the bars."""
    grid, drawn, limit = result
    return {
        "_map": grid.plot.map(
            x=DAMPING, onset=0.0, proved=lambda x: limit, proved_label="passive, proved"
        ),
        "_sensitivity": drawn.plot.sensitivity(),
    }


def numbers(result: tuple[Study, Study, float]) -> xarray.Dataset:
    """Both data sets in one."""
    grid, drawn, limit = result
    plane = grid.data.rename({n: f"{n}_of_map" for n in grid.data.variables})
    return xarray.merge(
        [plane, drawn.data], combine_attrs="override", compat="override", join="outer"
    ).assign_attrs(drawn.data.attrs | {"largest_proved": limit})


if __name__ == "__main__":
    write_study(__file__, __doc__, run, text=summary, figures=figures, numbers=numbers)
