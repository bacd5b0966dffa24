"""compute and prove how much friction may be compensated before a device can release energy"""

from __future__ import annotations

import argparse
import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..base.errors import ExperimentError
from ..base.files import read_whole
from ..base.sentences import wrap
from ._arms import add_body
from ._claims import claim_data, claim_lines, is_diagram, settle_diagram
from ._diagnosis import body_of_source
from ._options import (
    add_answer,
    add_effect_files,
    add_law_files,
    add_output,
    refuse_options,
    require_positive,
    write_requested,
)

if TYPE_CHECKING:
    from ..controllers import Stage
    from ..passivity.device_claims import Margin
    from ..passivity.identified import IdentifiedDevice
    from ..passivity.theorems import TopicClaim
    from ..simulate import Sampling


#: options that describe a compensator or choose a body of a diagnosis
OF_A_DEVICE = ("answer", "body", "dahl", "smoothed_coulomb", "wall")

EXAMPLES = """
  teleopdesign passivity answer.json --dahl 0.8 20000 --period 0.001
  teleopdesign passivity interface.toml --json claims.json
  teleopdesign passivity --check claims.json
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "source",
        nargs="?",
        type=Path,
        help="folder with experiment.toml, which is then diagnosed; or the answer of a diagnosis "
        "(.json); or a diagram: a file NAME.toml, or the name of a diagram of the package",
    )
    add_answer(parser)
    add_body(parser, pose=True)
    _add_compensator(parser)
    _add_computer(parser)
    parser.add_argument(
        "--stroke",
        type=float,
        default=0.01,
        metavar="AMPLITUDE",
        help="for a diagram: largest position in the search for a motion that releases energy, m "
        "or rad (default: %(default)g)",
    )
    parser.add_argument(
        "--speed",
        type=float,
        default=0.1,
        metavar="SPEED",
        help="for a diagram: largest speed in this search, m/s or rad/s (default: %(default)g)",
    )
    add_output(parser, "--json", "write claims, certificates and motions")
    parser.add_argument(
        "--check",
        type=Path,
        metavar="F",
        help="only check the certificates in a file that --json wrote",
    )
    add_effect_files(parser)
    add_law_files(parser)


def _add_compensator(parser: argparse.ArgumentParser) -> None:
    """Arguments: the law of the compensation that is judged, if there is one."""
    law = parser.add_mutually_exclusive_group()
    law.add_argument(
        "--dahl",
        nargs=2,
        type=float,
        metavar=("LEVEL", "STIFFNESS"),
        help="compensation by a Dahl model: friction level (N or N m) and bristle stiffness (N/m "
        "or N m/rad)",
    )
    law.add_argument(
        "--smoothed-coulomb",
        nargs=2,
        type=float,
        metavar=("LEVEL", "VELOCITY"),
        help="compensation LEVEL v/(VELOCITY + |v|): friction level (N or N m) and the velocity at "
        "which half of it is reached (m/s or rad/s)",
    )


def _add_computer(parser: argparse.ArgumentParser) -> None:
    """Arguments: the sampling of the computer, and the virtual wall that it renders."""
    parser.add_argument("--period", type=float, metavar="T", help="sample period, s")
    parser.add_argument(
        "--delay",
        type=float,
        default=0.0,
        metavar="DELAY",
        help="delay of the computer, s, a whole number of periods (default: 0); needs --period",
    )
    parser.add_argument(
        "--encoder-step",
        type=float,
        default=0.0,
        metavar="STEP",
        help="step of the encoder, m or rad (default: 0, no step); needs --period",
    )
    parser.add_argument(
        "--wall",
        nargs=2,
        type=float,
        metavar=("STIFFNESS", "DAMPING"),
        help="virtual wall: stiffness (N/m or N m/rad) and damping (N s/m or N m s/rad); needs "
        "--period",
    )


def run(options: argparse.Namespace) -> int:
    """Print claims and margins; write the requested file. The exit status ignores verdicts."""
    if options.check is not None:
        return _check_file(options.check)
    _check_options(options)
    if is_diagram(options.source):
        return settle_diagram(options, _make_sampling(options))
    from ..passivity.device_claims import margins
    from ..passivity.identified import identify_device

    body, reach, basis = body_of_source(options.source, options)
    print(basis.sentence(body.axis))
    device = identify_device(body, reach, basis)
    compensator = _choose_compensator(options)
    claims = _settle_claims(options, device, compensator)
    limits = margins(device, compensator)
    print(_describe_device(device, claims, limits))
    if options.period is not None and device.damping.low > 0:
        print("\n" + _describe_z_width(device, options.period, options.delay))
    content = {
        "basis": basis.sentence(body.axis),
        "claims": [claim_data(s) for s in claims],
        "margins": [vars(m) for m in limits],
    }
    write_requested(options, json=lambda: content)
    return 0


def _check_options(options: argparse.Namespace) -> None:
    if options.source is None:
        raise ExperimentError(
            "passivity: expected a folder, an answer (.json), a diagram (.toml), or --check F"
        )
    require_positive(options, ("stroke", "speed"))
    require_positive(options, ("period",), " s")
    if is_diagram(options.source):
        refuse_options(options, OF_A_DEVICE, "found beside a diagram, which has its own blocks")
    for name in ("dahl", "smoothed_coulomb"):
        values = getattr(options, name)
        if values is not None and not all(math.isfinite(x) and x > 0 for x in values):
            raise ExperimentError(
                f"--{name.replace('_', '-')}: found {values}, expected two numbers > 0"
            )
    if min(options.delay, options.encoder_step) < 0:
        raise ExperimentError("--delay, --encoder-step: expected no negative number")
    late = options.delay / options.period if options.period else 0.0
    if abs(late - round(late)) > 1e-6:
        raise ExperimentError(
            f"--delay: found {late:.4g} periods, expected a whole number: the proofs for sampled "
            "laws need one"
        )
    if options.period is None and (options.wall or options.delay or options.encoder_step):
        raise ExperimentError("--wall, --delay, --encoder-step: they need --period")


def _choose_compensator(options: argparse.Namespace) -> Stage | None:
    from ..controllers import CONTROLLERS, Stage

    for name in ("dahl", "smoothed_coulomb"):
        if (values := getattr(options, name)) is not None:
            law = CONTROLLERS[name]
            names = law.bound, law.bristle_stiffness or law.smoothing
            return Stage(law, dict(zip(names, values, strict=True)))
    return None


def _settle_claims(
    options: argparse.Namespace, device: IdentifiedDevice, compensator: Stage | None
) -> list[TopicClaim]:
    import numpy as np

    from ..passivity.device_claims import compensation_claims
    from ..passivity.theorems import Question, Wall, settle

    computer = _make_sampling(options)
    claims = settle(Question(device))
    if compensator is not None:
        rng = np.random.default_rng(1)
        claims += compensation_claims(device, compensator, computer=computer, rng=rng)
    if options.wall is not None and computer is not None:
        stiffness, damping = options.wall
        wall = Wall(stiffness, damping, (compensator and compensator.value_of("bound")) or 0.0)
        claims += settle(Question(device, wall=wall, computer=computer))
    return claims


def _make_sampling(options: argparse.Namespace) -> Sampling | None:
    from ..simulate import Sampling

    if options.period is None:
        return None
    return Sampling(options.period, options.delay, options.encoder_step)


def _describe_device(
    device: IdentifiedDevice, claims: Sequence[TopicClaim], limits: Sequence[Margin]
) -> str:
    force, stiff, damped = map(device.unit, ("force", "stiffness", "damping"))
    lines = [
        f"friction level: lowest {device.lowest} {force}, highest {device.highest} {force}, "
        f"over {device.over}"
    ]
    if device.presliding is None:
        lines.append(
            "presliding was not identified: friction is taken as ideal, even in the smallest motion"
        )
    else:
        lines.append(f"presliding stiffness {device.presliding} {stiff}")
    lines.append(f"damping at every speed {device.damping} {damped}")
    if device.bristle_damping.high > 0:
        lines.append(f"damping of the bristle {device.bristle_damping} {damped}")
    if device.set_aside:
        lines.append(
            f"may supply energy, or no theorem covers the effect: {', '.join(device.set_aside)}"
        )
    if device.unknown:
        lines.append(f"no standard error, taken as exact: {', '.join(device.unknown)}")
    return "\n".join([*lines, *claim_lines(claims), "", *map(str, limits)])


def _describe_z_width(device: IdentifiedDevice, period: float, delay: float) -> str:
    from ..base.sentences import round_down
    from ..passivity import z_width

    width = z_width(
        damping=device.damping.low,
        sample_time=period,
        inertia=device.body.parameters["inertia"].value,
        delay=round(delay / period),
    )
    k, b = width.stiffest
    checked = "exact test agrees at each limit" if width.verified else "evidence"
    stiff, damped = map(device.unit, ("stiffness", "damping"))
    k, b = (round_down(x, digits=4) for x in (k, b))
    return (
        f"Z-width at {period:g} s: stiffest passive wall {k:.4g} {stiff} with "
        f"damping {b:.4g} {damped}, "
        f"{width.width(1.0):.1f} dB above the free device at 1 Hz ({checked})"
    )


def _check_file(path: Path) -> int:
    """Check each certificate in a file of claims with the small checker only; returns 0."""
    from ..passivity.checker import Refused, check

    try:
        claims = json.loads(read_whole(path).decode("utf-8"))["claims"]
        certified = [(str(c["statement"]), list(c["certificates"])) for c in claims]
    except (OSError, ValueError, KeyError, TypeError, RecursionError) as problem:
        raise ExperimentError(f"{path}: no file of claims: {problem!r}"[:300]) from problem
    count = 0
    for statement, certificates in certified:
        title = ascii(statement)[1:-1]
        for certificate in certificates:
            try:
                shown = check(certificate)
            except Refused as problem:
                raise ExperimentError(f"{path}: {title}: {problem}") from None
            count += 1
            print(wrap(f"proved: {shown}", rest="    "))
        if certificates:
            print(wrap(f"title, not checked: {title}", rest="    ") + "\n")
    print(f"{count} certificate{'s' * (count != 1)} of {len(certified)} claims verified")
    return 0
