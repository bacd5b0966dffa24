"""What studies share: the arguments of their command line, and writing figures and numbers."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from teleopdesign.base.errors import ModelError
from teleopdesign.show import save_figure
from teleopdesign.studies import study

if TYPE_CHECKING:
    import matplotlib.figure


def values_over(model: Callable[..., Any], axes: Mapping[str, Any]) -> np.ndarray:
    """What a function gives at every point of the axes, as an array over those that vary.

    raises ModelError: a point failed, and why
    """
    dataset = study(model, axes, measures={"value": _itself})
    if dataset.failures:
        raise ModelError(f"{model.__name__}: {next(iter(dataset.failures))}")
    return np.asarray(dataset["value"].values)


def _itself(value: Any) -> Any:
    return value


def write_study(
    path: str,
    description: str,
    run: Callable[..., Any],
    *,
    quick: str = "fewer points",
    text: Callable[[Any], str] | None = None,
    plot: Callable[[Any], matplotlib.figure.Figure] | None = None,
    figures: Callable[[Any], Mapping[str, matplotlib.figure.Figure]] | None = None,
    numbers: Callable[[Any], Any] | None = None,
) -> None:
    """Run with the command line's arguments; write figures (PDF, SVG, PNG) and numbers.

    path: the study's own file, which names what is written;  quick: what --quick does
    text: of what `run` returns, the text that is printed (default: its finding, or itself)
    plot: draws it (default: its own plot), or figures: ending of the name -> figure
    numbers: what is written as netCDF (default: itself), and as JSON where it knows how
    """
    parser = argparse.ArgumentParser(description=description.split("\n")[0])
    parser.add_argument("--quick", action="store_true", help=quick)
    parser.add_argument("--output", type=Path, default=Path(path).parent / "output")
    arguments = parser.parse_args()
    arguments.output.mkdir(parents=True, exist_ok=True)
    result = run(quick=arguments.quick)
    print(text(result) if text else getattr(result, "attrs", {}).get("finding", result))
    target = arguments.output / Path(path).stem
    drawn = figures(result) if figures else {"": plot(result) if plot else result.plot()}
    for ending, figure in drawn.items():
        save_figure(figure, target.with_name(f"{target.name}{ending}"))
    written = result if numbers is None else numbers(result)
    written.to_netcdf(target.with_suffix(".nc"))
    if hasattr(written, "to_json"):
        written.to_json(target.with_suffix(".json"))
