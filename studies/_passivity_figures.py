"""What the studies of passivity share: their arguments, and writing figure and numbers."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from teleopdesign.plot import save_figure

if TYPE_CHECKING:
    import matplotlib.figure
    import xarray


def write_study(
    path: str,
    description: str,
    run: Callable[..., xarray.Dataset],
    plot: Callable[[xarray.Dataset], matplotlib.figure.Figure],
) -> None:
    """Run with the command line's arguments; write figure (PDF, SVG, PNG) and numbers (netCDF).

    path: the study's own file, which names what is written
    """
    parser = argparse.ArgumentParser(description=description.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help="fewer points")
    parser.add_argument("--output", type=Path, default=Path(path).parent / "output")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    data = run(quick=arguments.quick)
    print(data.attrs["finding"])
    target = arguments.output / Path(path).stem
    save_figure(plot(data), target)
    data.to_netcdf(target.with_suffix(".nc"))
