"""propose a friction compensation for the device that a diagnosis identified"""

from __future__ import annotations

import argparse
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import write_text
from ._arms import add_body, chosen_body, inertia_line, place_at_pose
from ._diagnosis import diagnosis_of, experiment_and_answer, print_diagnosis
from ._options import (
    add_experiment,
    add_output,
    check_output,
    make_folder,
    say_written,
    shell_word,
    write_requested,
)
from ._terminal import replace_line
from ._whole_diagram import diagnosed_diagram

if TYPE_CHECKING:
    from ..block_cuts import BlockDiagnosis
    from ..design import Assumptions, Design
    from ..diagnose import Diagnosis
    from ..measurement import Experiment

#: assumption -> (unit on the command line, what it is)
STATED = {
    "load": "inertia that stands for the hand, kg or kg*m^2 (default: three times the device's)",
    "sample_period": "sample period of the controller, s (default: that of the record)",
    "delay": "time from a sample to the change of the command, s (default: one sample period)",
    "bandwidth": "bandwidth of the low-pass in H, Hz (default: 20)",
    "velocity_bandwidth": "bandwidth of the velocity filter, Hz (default: 50, at most 0.1/period)",
    "errors": "half width of the interval of a friction level, in standard errors (default: 1.96)",
    "fraction": "part of the least friction level that is cancelled (default: 0.9)",
    "delay_factor": "the loop of H remains stable with X times its delay (default: 3)",
    "amplitude": "amplitude of the predicted motion, m or rad (default: a quarter of the travel)",
    "frequency": "frequency of the predicted motion, Hz (default: that with the recorded rms "
    "speed)",
}


EXAMPLES = """
  teleopdesign design answer.json --output design
  teleopdesign design rod --answer answer.json --load 0.5 --delay 0.001
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser)
    add_body(parser, pose=True)
    add_output(parser, "--json", "write the designs")
    add_output(parser, "--figure", "write the figure")
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="folder for figures, data and controllers"
    )
    for name, text in STATED.items():
        option = f"--{name.replace('_', '-')}"
        parser.add_argument(option, type=float, metavar="X", help=text)


def run(options: argparse.Namespace) -> int:
    """Print the design of each body; write the requested files."""
    from ..design import Assumptions

    if options.answer is not None:
        check_output(options.answer, (".json",))
    if options.output is not None:
        make_folder(options.output)
    names = {f.name for f in fields(Assumptions)}
    stated = {n: v for n in STATED if (v := getattr(options, n)) is not None and n in names}
    assumptions = Assumptions(**stated)
    if (whole := diagnosed_diagram(options)) is not None:
        return _run_diagram(whole, assumptions, options)
    experiment = experiment_and_answer(options)
    places = _places(options, experiment)
    diagnosis = _diagnosis_to_design_for(experiment, options, places[0])
    designs = {}
    for place in places:
        designs[place] = _design(diagnosis, place, assumptions)
        print("" if len(designs) == 1 else "\n", end="")
        print(designs[place])
    _write(designs, options)
    return 0


def _run_diagram(
    diagnosis: BlockDiagnosis, assumptions: Assumptions, options: argparse.Namespace
) -> int:
    """Design for a device of a whole diagram, with its computer and its hand."""
    from ..design.assumptions import device_of_diagram

    if options.answer is None:
        print_diagnosis(str(diagnosis))
    place = device_of_diagram(diagnosis, options.body, None)[1]
    designs = {place: _design(diagnosis, place, assumptions)}
    print(designs[place])
    _write(designs, options)
    return 0


def _places(options: argparse.Namespace, experiment: Experiment) -> list[str]:
    bodies = places = list(experiment.bodies)
    if experiment.arm is not None or options.body is not None:
        places = [chosen_body(bodies, options, experiment.folder.name)]
    if options.figure is not None and len(places) > 1:
        raise ExperimentError(f"--figure: shows one body, choose --body {' or '.join(bodies)}")
    return places


def _diagnosis_to_design_for(
    experiment: Experiment, options: argparse.Namespace, place: str
) -> Diagnosis:
    """The diagnosis, printed where it is computed now; of an arm, of one joint at a pose."""
    whole = diagnosis_of(experiment, options)
    diagnosis = whole.joints.get(place, whole)
    if options.answer is None:
        print_diagnosis(str(diagnosis))
        print()
    if diagnosis is whole:
        return whole
    model = place_at_pose(whole, place, options)
    print(f"{inertia_line(model, place, options)}\n")
    return diagnosis.with_final_model(model)


def _design(diagnosis: Diagnosis | BlockDiagnosis, place: str, assumptions: Assumptions) -> Design:
    from ..design import design

    replace_line(f"designing for {place}")
    proposal = design(diagnosis, place=place, assumptions=assumptions)
    replace_line("")
    return proposal


def _write(designs: dict[str, Design], options: argparse.Namespace) -> None:
    from ..show import save_figure

    write_requested(
        options,
        json=lambda: {"bodies": {place: d.as_dict() for place, d in designs.items()}},
        figure=next(iter(designs.values())).plot,
    )
    written: list[Path] = []
    diagrams: list[Path] = []
    for place, proposal in designs.items() if options.output is not None else ():
        files = save_figure(proposal.plot(), options.output / f"{place}_design")
        data = options.output / f"{place}_design.json"
        proposal.to_json(data)
        diagrams.append(options.output / f"{place}_interface.toml")
        write_text(diagrams[-1], proposal.to_toml())
        written += [*files, data, diagrams[-1]]
    say_written(*written)
    for diagram in diagrams:
        print(f"its transfer functions: teleopdesign derive {shell_word(diagram)}")
        print(f"its passivity: teleopdesign passivity {shell_word(diagram)}")
