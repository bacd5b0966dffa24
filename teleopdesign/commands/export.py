"""write an identified model for a rigid-body simulator: MJCF (MuJoCo) or URDF"""

from __future__ import annotations

import argparse
from pathlib import Path

from ..base.files import write_text
from ._arms import add_body
from ._diagnosis import model_of_source
from ._options import add_experiment, check_output

EXAMPLES = """
  teleopdesign export answer.json --to mjcf
  teleopdesign export rod --to urdf --output rod.urdf
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser)
    add_body(parser, pose=True)
    parser.add_argument("--to", required=True, choices=("mjcf", "urdf"), help="format of the file")
    parser.add_argument(
        "--output", type=Path, metavar="F", help="write this file (default: beside the answer)"
    )


def run(options: argparse.Namespace) -> int:
    """Write the file; print the parts of the model that it contains, and those left out."""
    from ..realise.simulator_files import ENDINGS, as_simulator_file

    ending = ENDINGS[options.to]
    path = options.output
    if path is not None:
        check_output(path, (ending,))
    model, source = model_of_source(options)
    if path is None:
        path = source.with_suffix(ending) if source.suffix == ".json" else Path(f"model{ending}")
        check_output(path, (ending,))
    file = as_simulator_file(model, options.to, name=path.stem)
    write_text(path, file.text)
    for name, value, unit, where in file.holds:
        print(f"  {name:<32} {value:<12.5g} {unit:<8} {where}")
    print("left out: " + (", ".join(file.left_out) or "nothing"))
    print(f"written: {path}")
    return 0
