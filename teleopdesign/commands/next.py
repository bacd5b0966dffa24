"""propose the experiment that best distinguishes the effects which a recording leaves open"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.errors import ExperimentError, unknown
from ..base.sentences import wrap
from ._arms import add_body
from ._diagnosis import diagnosis_of, diagnosis_of_part, experiment_and_answer, print_diagnosis
from ._options import (
    add_experiment,
    add_output,
    add_repeated,
    refuse_options,
    require_positive,
    say_written,
    split_pairs,
    value_from,
    write_requested,
)
from ._terminal import replace_line
from ._whole_diagram import diagnosed_diagram, is_diagram, print_next, print_what_to_log

if TYPE_CHECKING:
    from ..measurement import Experiment
    from ..next_experiment import Limits, Reference, SimulatedDiagnosis

#: limit -> its quantity, as units are checked
QUANTITY = {
    "low": "position",
    "high": "position",
    "speed": "velocity",
    "acceleration": "acceleration",
    "jerk": "dimensionless",
    "force": "force",
}


EXAMPLES = """
  teleopdesign next answer.json --output next.csv
  teleopdesign next interface.toml
  teleopdesign next rod --limit speed=0.2m/s --limit force=3N --duration 30
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    add_experiment(parser)
    add_body(parser)
    add_output(parser, "--output", "write the position reference", ".csv")
    add_output(parser, "--json", "write the proposal")
    add_output(parser, "--figure", "write the figure")
    add_repeated(
        parser,
        "--limit",
        "[BODY.]NAME=VALUE[UNIT]",
        "limit that replaces the largest value in the records: low, high, speed, acceleration, "
        "jerk or force, such as speed=0.2m/s; without a unit, in SI",
    )
    parser.add_argument(
        "--duration",
        type=float,
        default=20.0,
        metavar="S",
        help="longest duration of the motion, s (default: 20)",
    )
    parser.add_argument(
        "--simulate",
        nargs="?",
        type=float,
        const=120.0,
        metavar="S",
        help="for each possible effect, simulate the experiment with this effect and diagnose the "
        "result; no simulation starts after S seconds (default: 120)",
    )


def run(options: argparse.Namespace) -> int:
    """Print the proposed experiment and what it will show; write the requested files."""
    require_positive(options, ("duration",), " s")
    if is_diagram(options.folder):
        return print_what_to_log(options.folder)
    if (whole := diagnosed_diagram(options)) is not None:
        return print_next(whole)
    from ..next_experiment import propose, show_in_simulation

    experiment = experiment_and_answer(options)
    if experiment.arm is not None and options.body is None:
        return _run_arm(experiment, options)
    limits = _limits(_read_limits(options.limit, experiment), experiment)
    diagnosis = diagnosis_of_part(experiment, options)
    proposal = propose(diagnosis, duration=options.duration, limits=limits, progress=replace_line)
    replace_line("")
    print_diagnosis(str(diagnosis))
    print()
    print(_wrap(repr(proposal)))
    shown: Sequence[SimulatedDiagnosis] = ()
    if options.simulate is not None:
        shown = show_in_simulation(proposal, seconds=options.simulate, progress=replace_line)
        replace_line("")
        print("\n".join(["", *map(str, shown)]))
        print(f"true effect named in simulation: {sum(s.named for s in shown)} of {len(shown)}")
    reference = proposal.reference if proposal.is_useful else None
    _write_reference(reference, experiment, options.output)
    write_requested(options, json=lambda: _content(proposal, shown), figure=proposal.plot)
    return 0


def _run_arm(experiment: Experiment, options: argparse.Namespace) -> int:
    """Propose paths of all joints of an arm; with --body, `run` plans one joint instead."""
    from ..next_experiment import propose_paths, shown_limits

    refuse_options(
        options, ("figure", "simulate"), "not available for an arm: use --output, or --body JOINT"
    )
    stated = _read_limits(options.limit, experiment)
    diagnosis = diagnosis_of(experiment, options)
    limits = {
        j: shown_limits(diagnosis.joints[j].prepared)[j].with_values(**values)
        for j, values in stated.items()
    }
    paths = propose_paths(
        diagnosis, duration=options.duration, limits=limits, progress=replace_line
    )
    replace_line("")
    print_diagnosis(str(diagnosis))
    print(f"\n{_wrap('next experiment: ' + repr(paths))}")
    _write_reference(paths.reference if paths.is_useful else None, experiment, options.output)
    numbers = {n: getattr(paths, n) for n in ("condition", "recorded", "period")}
    content = {**numbers, "standard_errors": dict(paths.errors)}
    write_requested(options, json=lambda: content)
    return 0


def _write_reference(
    reference: Reference | None, experiment: Experiment, path: Path | None
) -> None:
    """Write the proposed motion, if a file is requested and a motion is proposed."""
    from ..next_experiment import write_reference

    if path is None:
        return
    if reference is None:
        print(f"\nnot written: {path}, because no motion is proposed")
        return
    write_reference(reference, experiment, path)
    say_written(path)


def _wrap(text: str) -> str:
    """The text with its first line wrapped; the other lines, a table, stay unchanged."""
    first, *rest = text.split("\n")
    return "\n".join([wrap(first), *rest])


def _content(proposal: Any, shown: Sequence[SimulatedDiagnosis]) -> dict[str, Any]:
    from ..next_experiment import proposal_data

    simulated = [
        {
            "truth": {"effect": s.truth.candidate.key[0], "at": s.truth.candidate.key[1]},
            "verdict": s.diagnosis.verdict,
            "named": s.named,
        }
        for s in shown
    ]
    return {**proposal_data(proposal), "simulation": simulated}


def _read_limits(texts: Sequence[str], experiment: Experiment) -> dict[str, dict[str, float]]:
    """Body -> limit -> value (SI), from the command line.

    raises ExperimentError: no such body or limit, or a wrong value
    """
    bodies = tuple(experiment.bodies)
    limits: dict[str, dict[str, float]] = {}
    for name, value in split_pairs(texts, "--limit").items():
        body, _, limit = name.rpartition(".")
        body, where = body or bodies[0], f"--limit {name}={value}"
        if body not in bodies:
            raise ExperimentError(f"{where}: {unknown('body', body, bodies)}")
        if limit not in QUANTITY:
            raise ExperimentError(f"{where}: {unknown('limit', limit, QUANTITY)}")
        axis, quantity = experiment.axis(body), QUANTITY[limit]
        size = value_from(value, quantity=quantity, axis=axis, where=where)
        limits.setdefault(body, {})[limit] = size
    return limits


def _limits(limits: dict[str, dict[str, float]], experiment: Experiment) -> dict[str, Limits]:
    """Body -> limits that its records have reached, replaced by the requested limits."""
    from ..measurement.prepare import prepare
    from ..next_experiment import shown_limits

    if not limits:
        return {}
    shown = shown_limits(prepare(experiment))
    return {body: shown[body].with_values(**values) for body, values in limits.items()}
