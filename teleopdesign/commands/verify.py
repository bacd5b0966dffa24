"""compare a recording made with the compensation on with what a design predicted"""

from __future__ import annotations

import argparse
from pathlib import Path

from ._options import add_output, write_requested
from ._terminal import replace_line

EXAMPLES = """
  teleopdesign verify design.json joint_compensated --figure verified.png
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument("design", type=Path, help="file that `design --json` wrote")
    parser.add_argument("folder", type=Path, help="experiment with the compensation switched on")
    parser.add_argument(
        "--without",
        type=Path,
        metavar="FOLDER",
        help="experiment of the same day without compensation: tells a changed device from a "
        "changed compensator",
    )
    parser.add_argument("--body", metavar="NAME", help="body, if the design has several")
    parser.add_argument(
        "--case",
        choices=("MBC", "FF", "hybrid"),
        help="what was switched on, if not as designed",
    )
    add_output(parser, "--figure", "write the figure")


def run(options: argparse.Namespace) -> int:
    """Print the comparison; status 0 whatever it says."""
    from ..design.verify import read_plan, verify
    from ..measurement import load_experiment

    plan = read_plan(options.design, options.body)
    experiment = load_experiment(options.folder)
    without = None if options.without is None else load_experiment(options.without)
    replace_line("comparing along the recorded motion")
    verified = verify(plan, experiment, case=options.case, without=without)
    replace_line("")
    print(verified)
    write_requested(options, figure=verified.plot)
    return 0
