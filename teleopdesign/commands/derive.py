"""derive every transfer function of a diagram, or of the device that a diagnosis identified"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ModelError, did_you_mean
from ._arms import add_body
from ._diagnosis import body_of_source
from ._options import (
    add_answer,
    add_effect_files,
    add_law_files,
    add_output,
    refuse_options,
    write_requested,
)

if TYPE_CHECKING:
    from ..derive import Transfers
    from ..diagrams import Diagram


EXAMPLES = """
  teleopdesign derive haptic-interface
  teleopdesign derive interface.toml --latex --figure interface.svg
  teleopdesign derive answer.json                   the identified device in a hand
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_diagram(parser)
    parser.add_argument(
        "--latex", action="store_true", help="print LaTeX, for an align environment"
    )
    add_output(parser, "--json", "write expressions and numbers")
    add_output(parser, "--figure", "draw the diagram")
    parser.add_argument(
        "--speed",
        type=float,
        default=0.0,
        metavar="V",
        help="speed, m/s or rad/s, at which smoothed friction and gain schedules are replaced by "
        "constants (default: 0)",
    )


def add_diagram(parser: argparse.ArgumentParser) -> None:
    """Arguments: a diagram, and what its file or the diagnosis behind it needs."""
    parser.add_argument(
        "diagram",
        help="a diagram: a TOML file, or the name of a diagram of the package (haptic-interface, "
        "world-haptics-2005, ...); or the answer of a diagnosis (.json); or a folder with "
        "experiment.toml, which is then diagnosed",
    )
    add_answer(parser)
    add_body(parser, pose=True)
    add_effect_files(parser)
    add_law_files(parser)


def run(options: argparse.Namespace) -> int:
    """Print the transfer functions, with numbers where the blocks have values."""
    from ..derive import all_transfers
    from ..show import draw_diagram

    diagram = diagram_from(options)
    transfers = all_transfers(diagram)
    print(transfers.latex() if options.latex else _page(transfers, options.speed))
    write_requested(
        options,
        json=lambda: transfers.as_data(speed=options.speed),
        figure=lambda: draw_diagram(diagram).plot(),
    )
    return 0


def diagram_from(options: argparse.Namespace) -> Diagram:
    """The diagram that the options name, or the haptic interface with an identified device."""
    from ..diagrams import SHIPPED, haptic_interface

    source = Path(options.diagram)
    is_experiment = source.name == "experiment.toml" or source.is_dir()
    if options.diagram not in SHIPPED and (is_experiment or source.suffix == ".json"):
        return haptic_interface(body_of_source(source, options)[0])
    refuse_options(
        options, ("answer", "body", "pose"), "found beside a diagram, which has its own blocks"
    )
    return diagram_of(options.diagram, options.effect, options.law)


def diagram_of(name: str, effects: Sequence[Path] = (), laws: Sequence[Path] = ()) -> Diagram:
    """The shipped diagram of that name, or the diagram in the file of that name.

    effects, laws: the user's files of effects and of control laws
    raises ModelError, ExperimentError: neither exists, or the file cannot be read
    """
    from .. import controllers
    from .. import effects as all_effects
    from ..diagrams import SHIPPED, load_shipped, read_diagram

    if name in SHIPPED:
        return load_shipped(name)
    path = Path(name)
    if path.suffix == ".toml" or path.exists():
        return read_diagram(
            path, effects=all_effects.catalogue(effects), laws=controllers.catalogue(laws)
        )
    raise ModelError(
        f'found "{name}", expected a file NAME.toml or one of {", ".join(SHIPPED)}'
        f"{did_you_mean(name, SHIPPED)}"
    )


def _page(transfers: Transfers, speed: float) -> str:
    from ..base.units import unit_of
    from ..diagrams.units import first_axis

    lines = [repr(transfers.diagram), "", transfers.text()]
    if transfers.has_values:
        unit = unit_of("velocity", first_axis(transfers.diagram))
        at = f"frozen at a speed of {abs(speed):g} {unit}"
        lines += ["", f"With values, one degree of freedom, SI, {at}:"]
        lines += _numbers(transfers, speed)
    return "\n".join(lines)


def _numbers(transfers: Transfers, speed: float) -> list[str]:
    from ..derive.printing import polynomial_as_text

    lines, gone = [], set()
    for name, one in transfers.transfers.items():
        try:
            system, left_out = one.system(speed=speed)
        except ModelError as error:
            lines.append(str(error))
            continue
        gone |= set(left_out)
        above, below = (polynomial_as_text(p[0][0]) for p in (system.num, system.den))
        lines.append(f"{name} = ({above}) / ({below})")
    if gone:
        lines.append(f"Left out, because they have no linear form: {', '.join(sorted(gone))}")
    return lines
