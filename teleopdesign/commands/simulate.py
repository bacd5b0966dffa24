"""simulate a diagram: its signals over time, as a table, a file and a figure"""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from ._options import add_output, add_repeated, split_pairs, value_in, write_requested
from .derive import add_diagram, diagram_from

if TYPE_CHECKING:
    from ..studies import SimulatedCase

EXAMPLES = """
  teleopdesign simulate interface.toml --duration 2 --motion L 10mm 2Hz --figure run.svg
  teleopdesign simulate interface.toml --duration 1 --value initial.X=5mm --value C.dahl.level=0.8
  teleopdesign simulate answer.json --duration 2 --motion L 10mm 1Hz --output run.csv
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_diagram(parser)
    parser.add_argument("--duration", required=True, metavar="T", help="time to simulate, s")
    for name, text in (
        ("motion", "a position that is prescribed; the force that this takes is a result"),
        ("input", "a signal from outside, such as a force; 0 by default"),
    ):
        parser.add_argument(
            f"--{name}",
            nargs=3,
            action="append",
            default=[],
            metavar=("SIGNAL", "AMPLITUDE", "FREQUENCY"),
            help=f"{text}: a sine, such as 10mm 2Hz (may be repeated)",
        )
    add_repeated(
        parser,
        "--value",
        "NAME=VALUE",
        "another value, with or without a unit: of the diagram (C.dahl.level=0.8N), at the start "
        "(initial.X=5mm), from outside (inputs.F=1N), of the computer (computer.delay=1ms, "
        "computer.period) or of the simulation (step, give)",
    )
    parser.add_argument(
        "--continuous",
        action="store_true",
        help="controllers in continuous time (default: sampled at 1 kHz)",
    )
    parser.add_argument(
        "--every-step", action="store_true", help="rows at every inner step, not every sample"
    )
    parser.add_argument(
        "--error",
        action="store_true",
        help="state the error of the step for each signal, by further runs (7 times the work)",
    )
    text = "a signal of the figure; default: motion, commanded force and force of interaction"
    add_repeated(parser, "--signal", "NAME", text)
    add_output(parser, "--output", "write the signals over time", ".csv", ".nc")
    add_output(parser, "--figure", "draw signals over time")


def run(options: argparse.Namespace) -> int:
    """Print the size of every signal, and write the requested files."""
    from ..simulate import simulate

    case = _case(options)
    result = simulate(case.diagram, **case.settings(), estimate_error=options.error)
    for name in options.signal:
        result[name]  # refused here, before anything is written
    print(result)
    writers = {".csv": result.to_csv, ".nc": result.to_netcdf}
    write_requested(
        options,
        {
            "output": lambda path: writers[path.suffix](path),
        },
        figure=lambda: result.plot(*options.signal),
    )
    return 0


def _case(options: argparse.Namespace) -> SimulatedCase:
    """The diagram with the settings that the options state."""
    from ..simulate import Sampling, sine
    from ..simulate.units import signal_units
    from ..studies import SimulatedCase

    diagram = diagram_from(options)
    units = signal_units(diagram)

    def sines(option: str) -> dict[str, Any]:
        made = {}
        for signal, amplitude, frequency in getattr(options, option):
            where, unit = f"--{option} {signal}", units(diagram.signal(signal))
            size = value_in(amplitude, unit=unit, where=where)
            made[signal] = sine(
                amplitude=size, frequency=value_in(frequency, unit="Hz", where=where)
            )
        return made

    case = SimulatedCase(
        diagram,
        duration=value_in(options.duration, unit="s", where="--duration"),
        motion=sines("motion"),
        inputs=sines("input"),
        every_step=options.every_step,
        computer="continuous" if options.continuous else Sampling(),
    )
    return case.with_values(_values(options.value, case))


def _values(texts: list[str], case: SimulatedCase) -> dict[str, float]:
    """Values by name, in SI, of texts such as "C.dahl.level=0.8N"."""
    values = {}
    for text, value in split_pairs(texts, "--value").items():
        name = text.strip()
        case.check_names([name])
        values[name] = value_in(value, unit=case.unit(name), where=f"--value {name}")
    return values
