"""diagnose the experiment that ships with the package"""

from __future__ import annotations

import argparse
from pathlib import Path

from . import diagnose
from ._options import make_folder

EXAMPLES = """
  teleopdesign demo
  teleopdesign demo --output first_look
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "--output",
        type=Path,
        default=Path("demo"),
        help="folder for the files that are written (default: demo)",
    )


def run(options: argparse.Namespace) -> int:
    """Diagnose the shipped experiment; all possible outputs are written into one folder."""
    from ..examples import example

    output = make_folder(options.output)
    written = {
        "json": output / "answer.json",
        "predictions": output / "predictions.csv.gz",
        "figure": output / "ladder.png",
        "report": output / "report.html",
    }
    print("The example experiment of the package, compared with a model that lacks an effect:\n")
    parser = argparse.ArgumentParser()
    diagnose.add(parser)
    arguments = [f"--{name}={path}" for name, path in written.items()]
    return diagnose.run(parser.parse_args([str(example("rod")), *arguments]))
