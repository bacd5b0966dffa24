"""Write what the package answers today into a folder; see the README beside this file.

python golden/freeze.py OUT [PART ...] [--whole]
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import math
import re
import sys
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
#: measurements that are not part of the project; the parts that need them are left out without
SHARED = ROOT.parent / "shared"
#: simulated cases of which a refactoring needs the answers: of each kind of what is missing
#: at least one (outside the catalogue, nothing, actuation, inertia, force, friction, two at once)
CASES = ("001", "004", "005", "006", "007", "010", "012", "016", "022", "024", "025", "027")
#: real recordings whose diagnosis takes seconds
RECORDINGS = ("cicese_gravity", "cicese_presliding", "ur10e_joint1")
#: effects that these diagnoses choose from; the whole catalogue takes five times as long
CANDIDATES = (
    "viscous", "coulomb", "coulomb_asymmetry", "stribeck", "presliding", "bias", "spring",
    "added_inertia", "actuation_delay", "actuator_lag", "cogging", "friction_drift", "gravity",
    "shear_thinning",
)  # fmt: skip
#: with --whole, draws of the tests' own simulator too: (number of cases, seed)
DRAWN = (30, 20261)
#: candidates of an answer that are kept, best first
BEST = 5
#: instants of a simulation that are kept
INSTANTS = 25


def derivations() -> dict[str, Any]:
    """Every transfer function of every shipped diagram, as it is printed and as LaTeX."""
    from teleopdesign.derive import all_transfers
    from teleopdesign.diagrams import SHIPPED, load_shipped
    from teleopdesign.realise.tips import linear_tips

    texts = {}
    for name in sorted(SHIPPED):
        transfers = all_transfers(linear_tips(load_shipped(name)))
        texts[name] = {"text": repr(transfers).splitlines(), "latex": transfers.latex().split("\n")}
    return texts


def simulations() -> dict[str, Any]:
    """Signals of the diagrams that ship, with friction, at some instants."""
    from teleopdesign.blocks import Body, Value
    from teleopdesign.controllers import controller, scheduled_force_feedback
    from teleopdesign.diagrams import four_cases, haptic_interface, teleoperator
    from teleopdesign.effects import EFFECTS
    from teleopdesign.simulate import Sampling, simulate

    def device(*effects: tuple[str, dict[str, float]]) -> Body:
        body = Body("prismatic", {"inertia": Value(0.15)})
        for name, values in effects:
            body = body.with_effect(EFFECTS[name], values)
        return body

    def push(t: float) -> float:
        return 2.0 * np.sin(2 * np.pi * 4 * t)

    coulomb = ("coulomb", {"level": 0.5})
    soft = ("presliding", {"stiffness": 2e4})
    plants = {
        "ideal friction": device(coulomb, ("viscous", {"damping": 0.4})),
        "lugre": device(
            coulomb,
            soft,
            ("viscous", {"damping": 0.4}),
            ("stribeck", {"extra_static_level": 0.2, "stribeck_velocity": 0.01}),
        ),
        "compliance": device(
            coulomb,
            soft,
            (
                "transmission_compliance",
                {"tip_inertia": 0.05, "stiffness": 4e3, "damping": 1.0},
            ),
        ),
    }
    cancel = controller("dahl", {"level": 0.4, "stiffness": 1e4})
    feed = scheduled_force_feedback(gain=5.0, scheduling_velocity=0.08, bandwidth=20.0)
    runs: dict[str, Any] = {}
    for name, plant in plants.items():
        whole = haptic_interface(plant, hand=device(), cancellation=cancel, force_feedback=feed)
        for case, diagram in four_cases(whole).items():
            for computer in ("continuous", Sampling(period=1e-3)):
                time_axis = "continuous" if isinstance(computer, str) else "sampled"
                runs[f"haptic interface, {name}, {case}, {time_axis}"] = simulate(
                    diagram, duration=0.5, inputs={"R_V": push}, computer=computer
                )
    link = controller("spring_damper", {"stiffness": 200.0, "damping": 3.0})
    coupled = teleoperator(plants["lugre"], plants["ideal friction"], coupling=link, hand=device())
    runs["teleoperator"] = simulate(
        coupled, duration=0.5, inputs={"F_u": push}, computer=Sampling(period=1e-3)
    )
    return {name: _at_instants(run) for name, run in runs.items()}


def _at_instants(run: Any) -> dict[str, Any]:
    data = run.data
    chosen = np.linspace(0, data.sizes["time"] - 1, INSTANTS).astype(int)
    return {
        str(name): [float(x) for x in np.asarray(data[name].values)[chosen].ravel()]
        for name in sorted(map(str, data.data_vars))
    }


def claims() -> dict[str, Any]:
    """Claims of the package's own example and of linear systems, with their certificates."""
    import sympy as sp

    from teleopdesign import passivity as p

    s = sp.Symbol("s")
    made = {
        "rod and spring": p.positive_real(0.15 * s + 4 + 300 / s),
        "active": p.positive_real((s**2 - 0.1 * s + 1) / (s + 1) ** 2),
        "teleoperator": p.passive(
            p.teleoperator_two_port(
                master=0.2 * s + 3, slave=0.3 * s + 4, stiffness=200.0, damping=2.0
            )
        ),
        "absolutely stable": p.absolutely_stable(
            p.teleoperator_two_port(
                master=0.2 * s + 3, slave=0.3 * s + 4, stiffness=200.0, damping=2.0
            )
        ),
        "late": p.passive(
            p.teleoperator_two_port(
                master=0.2 * s + 3, slave=0.3 * s + 4, stiffness=200.0, delay=0.05
            )
        ),
        "dahl beside coulomb": p.dahl_compensation(
            coulomb_level=0.5, compensator_level=0.4, compensator_stiffness=1e4
        ),
        "dahl beside dahl": p.dahl_compensation(
            coulomb_level=0.5,
            compensator_level=0.4,
            compensator_stiffness=1e4,
            presliding_stiffness=2e4,
        ),
        "too much": p.dahl_compensation(
            coulomb_level=0.5, compensator_level=0.6, compensator_stiffness=1e4
        ),
        "bounded": p.bounded_compensation(coulomb_level=0.5, bound=0.4),
    }
    return {name: _claim(claim) for name, claim in made.items()}


def _claim(claim: Any) -> dict[str, Any]:
    return {
        "status": claim.status,
        "said": repr(claim).splitlines(),
        "certificates": [dict(c.content) for c in claim.certificates],
    }


#: times, which the load of the machine decides
TIMED = re.compile(r" in \d+ s(?=:)")


def pages() -> dict[str, Any]:
    """What commands print for the example that ships with the package."""
    from teleopdesign.cli import main
    from teleopdesign.commands import _progress
    from teleopdesign.examples import example

    _progress.BETWEEN_LINES = math.inf  # lines of progress tell how fast the machine is
    rod = str(example("rod"))
    texts = {}
    for words in (
        ["effects"],
        ["check-papers"],
        ["check", rod],
        ["describe", rod],
        ["design", rod],
        ["passivity", rod, "--dahl", "0.3", "20000", "--period", "0.001"],
        ["passivity", "haptic-interface"],
    ):
        output = io.StringIO()
        with contextlib.redirect_stdout(output), contextlib.redirect_stderr(output):
            status = main(words)
        text = TIMED.sub("", output.getvalue().replace(rod, "rod").replace(str(ROOT), ""))
        name = " ".join("rod" if word == rod else word for word in words)
        texts[name] = {"status": status, "text": text.splitlines()}
    return texts


def answers() -> dict[str, Any]:
    """Answers on simulated cases beside the project, among few effects."""
    return _diagnosed({f"hidden {c}": SHARED / "hidden" / "cases" / c for c in CASES}, CANDIDATES)


def recordings() -> dict[str, Any]:
    """Answers on real recordings beside the project, among few effects."""
    return _diagnosed({name: SHARED / "data" / name for name in RECORDINGS}, CANDIDATES)


def whole_answers() -> dict[str, Any]:
    """Answers among the whole catalogue on all simulated cases, and draws of the tests' own."""
    sys.path[:0] = [str(ROOT / "studies"), str(ROOT / "tests")]
    from _campaign import plan
    from _one_case import make

    with tempfile.TemporaryDirectory() as scratch:
        jobs = {f"hidden {f.name}": f for f in sorted((SHARED / "hidden" / "cases").glob("*"))}
        for case in plan(DRAWN[0], seed=DRAWN[1]):
            planned = {k: v for k, v in vars(case).items()}
            make(Path(scratch), case.name, planned)
            jobs[f"drawn {case.name}"] = Path(scratch) / "cases" / case.name
        return _diagnosed(jobs)


def whole_recordings() -> dict[str, Any]:
    """Answers among the whole catalogue on all real recordings beside the project."""
    folders = sorted(f.parent for f in (SHARED / "data").glob("*/experiment.toml"))
    return _diagnosed({f.name: f for f in folders})


def _diagnosed(folders: dict[str, Path], only: Sequence[str] = ()) -> dict[str, Any]:
    there = {n: f for n, f in folders.items() if (f / "experiment.toml").is_file()}
    with ProcessPoolExecutor(max_workers=2) as pool:
        each = pool.map(_answer, there.values(), [tuple(only)] * len(there))
        return dict(zip(there, each, strict=True))


def _answer(folder: Path, effects: tuple[str, ...]) -> dict[str, Any]:
    from teleopdesign.cli import main

    with tempfile.TemporaryDirectory() as scratch:
        path, errors = Path(scratch) / "answer.json", io.StringIO()
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(errors):
            only = ["--only", *effects] if effects else []
            status = main(["diagnose", str(folder), *only, "--json", str(path)])
        if status != 0:
            return {"status": status, "said": errors.getvalue().strip().replace(str(folder), "")}
        answer = json.loads(path.read_text(encoding="utf-8"))
    keep = ("verdict", "missing", "ladder", "noise_floor", "indistinguishable", "model_parameters")
    kept = {name: answer[name] for name in keep if name in answer}
    return {**kept, "candidates": answer["candidates"][:BEST]}


PARTS: dict[str, Callable[[], dict[str, Any]]] = {
    "derivations": derivations,
    "simulations": simulations,
    "claims": claims,
    "pages": pages,
    "answers": answers,
    "recordings": recordings,
}
#: what --whole puts in their place
WHOLE = {"answers": whole_answers, "recordings": whole_recordings}


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the parts that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("parts", nargs="*", metavar="PART", help=", ".join(PARTS))
    parser.add_argument("--whole", action="store_true", help="all cases, the whole catalogue")
    options = parser.parse_args(arguments)
    parts = {**PARTS, **WHOLE} if options.whole else PARTS
    options.output.mkdir(parents=True, exist_ok=True)
    for part in options.parts or parts:
        lines = json.dumps(parts[part](), indent=0, sort_keys=True)
        (options.output / f"{part}.json").write_text(lines + "\n", encoding="utf-8")
        print(part, flush=True)


if __name__ == "__main__":
    main()
