"""Quick parts of the golden files: what the package prints, derives, proves, simulates and reads.

Each part is a function without arguments that returns plain data. Only what a user can call is
used: the names of `teleopdesign`, its folders of definitions, the command line, saved files.
"""

from __future__ import annotations

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

import teleopdesign as td
from teleopdesign.cli import main

ROOT = Path(__file__).resolve().parents[1]
#: instants of a simulation that are kept
INSTANTS = 21
#: times, which the load of the machine decides
TIMED = re.compile(r" in \d+ s(?=:)")


def command(words: Sequence[str]) -> tuple[int, str, str]:
    """Exit status, standard output and standard error of `teleopdesign WORDS`."""
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            status = main(list(words))
        except SystemExit as end:
            status = int(end.code or 0)
    return status, output.getvalue(), errors.getvalue()


# -- derivations and responses --------------------------------------------------------------------


def derivations() -> dict[str, Any]:
    """What `derive` prints for every diagram that ships: wiring, transfer functions, LaTeX."""
    texts = {}
    for name in sorted(td.diagrams.SHIPPED):
        status, text, errors = command(["derive", name])
        _, latex, _ = command(["derive", name, "--latex"])
        texts[name] = {
            "status": status,
            "text": (text + errors).splitlines(),
            "latex": latex.splitlines(),
        }
    return texts


def responses() -> dict[str, Any]:
    """Frequency responses of linear diagrams, of one with a delay, and of a teleoperator."""
    feedback = td.controller("low_pass", {"bandwidth": 20.0})
    feedback = feedback.then(td.controller("gain", {"gain": 2.0}))
    light = device(("viscous", {"damping": 0.4}))
    late = device(("viscous", {"damping": 0.4}), ("actuation_delay", {"delay": 2e-3}))
    link = td.controller("spring_damper", {"stiffness": 200.0, "damping": 3.0})
    diagrams = {
        "force feedback": td.haptic_interface(light, hand=device(), force_feedback=feedback),
        "late actuation": td.haptic_interface(late, hand=device(), force_feedback=feedback),
        "apparent impedance": td.haptic_interface(light, force_feedback=feedback),
        "teleoperator": td.teleoperator(light, light, coupling=link, hand=device()),
    }
    frequencies = np.geomspace(0.1, 200.0, 9)
    signals = {
        "force feedback": ("R_M", "R_D", ""),
        "late actuation": ("R_M", "R_D", ""),
        "apparent impedance": ("E", "L", "L"),
        "teleoperator": ("X_s", "F_u", ""),
    }
    rows = {}
    for name, (output, source, prescribed) in signals.items():
        ends = {"output": output, "input": source, "given": prescribed}
        response = td.bode(diagrams[name], frequency=frequencies, **ends)
        rows[name] = _dataset(response.data)
    return rows


# -- simulations ----------------------------------------------------------------------------------


def device(*effects: tuple[str, dict[str, float]]) -> Any:
    """A rod of 0.15 kg with these effects."""
    body = td.Body("prismatic", {"inertia": td.Value(0.15)})
    for name, values in effects:
        body = body.with_effect(td.EFFECTS[name], values)
    return body


COULOMB = ("coulomb", {"level": 0.5})
SOFT = ("presliding", {"stiffness": 2e4})
VISCOUS = ("viscous", {"damping": 0.4})


def plants() -> dict[str, Any]:
    """Devices with friction: ideal, LuGre, behind a compliant transmission."""
    stribeck = ("stribeck", {"extra_static_level": 0.2, "stribeck_velocity": 0.01})
    compliance = {"tip_inertia": 0.05, "stiffness": 4e3, "damping": 1.0}
    return {
        "ideal friction": device(COULOMB, VISCOUS),
        "lugre": device(COULOMB, SOFT, VISCOUS, stribeck),
        "compliance": device(COULOMB, SOFT, VISCOUS, ("transmission_compliance", compliance)),
    }


def push(t: float) -> float:
    """Force of 2 N at 4 Hz."""
    return 2.0 * math.sin(2 * math.pi * 4 * t)


def controllers() -> tuple[Any, Any]:
    """Dahl cancellation, and force feedback that fades with speed."""
    cancel = td.controller("dahl", {"level": 0.4, "stiffness": 1e4})
    fading = td.controller("velocity_schedule", {"gain": 5.0, "scheduling_velocity": 0.08})
    return cancel, fading.then(td.controller("low_pass", {"bandwidth": 20.0}))


def simulations() -> dict[str, Any]:
    """Signals of the diagrams that ship, with friction, at some instants."""
    cancel, feed = controllers()
    cases: dict[str, dict[str, Any]] = {
        "without": {},
        "cancellation": {"cancellation": cancel},
        "force feedback": {"force_feedback": feed},
        "hybrid": {"cancellation": cancel, "force_feedback": feed},
    }
    sampled, run = td.Sampling(period=1e-3), td.simulate_diagram
    runs: dict[str, Any] = {}
    for name, plant in plants().items():
        for case, laws in cases.items():
            diagram = td.haptic_interface(plant, hand=device(), **laws)
            for how, computer in (("continuous", "continuous"), ("sampled", sampled)):
                runs[f"haptic interface, {name}, {case}, {how}"] = run(
                    diagram, duration=0.5, inputs={"R_V": push}, computer=computer
                )
    link = td.controller("spring_damper", {"stiffness": 200.0, "damping": 3.0})
    made = plants()
    coupled = td.teleoperator(made["lugre"], made["ideal friction"], coupling=link, hand=device())
    runs["teleoperator"] = run(coupled, duration=0.5, inputs={"F_u": push}, computer=sampled)
    return {name: at_instants(each.data) for name, each in runs.items()}


def at_instants(data: Any) -> dict[str, Any]:
    """Every signal of a data set at INSTANTS of its times."""
    chosen = np.linspace(0, data.sizes["time"] - 1, INSTANTS).astype(int)
    return {
        str(name): [float(x) for x in np.asarray(data[name].values)[chosen].ravel()]
        for name in sorted(map(str, data.data_vars))
    }


# -- claims ---------------------------------------------------------------------------------------


def claims() -> dict[str, Any]:
    """Claims of the package's own example and of linear systems, with their certificates."""
    import sympy as sp

    p, s = td.passivity, sp.Symbol("s")
    master, slave = 0.2 * s + 3, 0.3 * s + 4
    coupled = p.teleoperator_two_port(master=master, slave=slave, stiffness=200.0, damping=2.0)
    late = p.teleoperator_two_port(master=master, slave=slave, stiffness=200.0, delay=0.05)
    dahl, friction = p.dahl_compensation, {"coulomb_level": 0.5, "compensator_stiffness": 1e4}
    made = {
        "rod and spring": p.positive_real(0.15 * s + 4 + 300 / s),
        "active": p.positive_real((s**2 - 0.1 * s + 1) / (s + 1) ** 2),
        "teleoperator": p.passive(coupled),
        "absolutely stable": p.absolutely_stable(coupled),
        "late": p.passive(late),
        "dahl beside coulomb": dahl(compensator_level=0.4, **friction),
        "dahl beside dahl": dahl(compensator_level=0.4, presliding_stiffness=2e4, **friction),
        "too much": dahl(compensator_level=0.6, **friction),
        "bounded": p.bounded_compensation(coulomb_level=0.5, bound=0.4),
    }
    cancel, feed = controllers()
    whole = td.haptic_interface(plants()["lugre"], hand=device(), cancellation=cancel)
    fed = td.haptic_interface(device(VISCOUS), force_feedback=feed)
    of_diagrams = {
        f"{name}, claim {k + 1}": claim.claim
        for name, diagram in (("cancellation", whole), ("force feedback", fed))
        for k, claim in enumerate(td.diagram_claims(diagram).claims)
    }
    return {name: _claim(claim) for name, claim in (made | of_diagrams).items()}


def _claim(claim: Any) -> dict[str, Any]:
    return {
        "status": claim.status,
        "said": repr(claim).splitlines(),
        "certificates": [dict(c.content) for c in claim.certificates],
    }


# -- studies --------------------------------------------------------------------------------------


def product(x: float, y: float) -> float:
    """A model without simulation."""
    return x * math.sin(y)


def value(result: float) -> float:
    """The number itself, as a measure."""
    return result


def less_gain(diagram: Any) -> float:
    """An objective: the more force feedback, the better."""
    return -float(diagram.values["H.gain.gain"])


def slowness(diagram: Any) -> float:
    """An objective against the first one: a wide band."""
    return 1 / float(diagram.values["H.low_pass.bandwidth"])


def studies() -> dict[str, Any]:
    """A study on a grid, of samples and of claims, many simulations at once, and tuning."""
    return {**_studied(), "many": _many(), **_tuned()}


def _studied() -> dict[str, Any]:
    cancel, _ = controllers()
    interface = td.haptic_interface(device(COULOMB, VISCOUS), cancellation=cancel)
    moved = {"duration": 0.2, "motion": {"L": td.sine(amplitude=0.01, frequency=5.0)}}
    grid = td.study(
        interface,
        {"C.dahl.level": [0.2, 0.4, 0.6], "computer.delay": [0.0, 1e-3]},
        measures={
            "force_error": "force_error",
            "drawn": "energy_drawn",
            "hand": td.measure("peak", signal="R_M"),
            "rms": td.measure("rms", signal="R_M", after=0.05),
        },
        workers=1,
        **moved,
    )
    drawn = td.study(
        product,
        td.sensitivity_samples({"x": (0.0, 1.0), "y": (0.0, 3.0)}, 32, seed=1),
        measures={"z": value},
        workers=1,
    )
    cube = td.study(
        interface,
        td.latin_hypercube({"C.dahl.level": (0.1, 0.6), "Z_M.inertia": (0.1, 0.2)}, 6, seed=2),
        measures={"hand": td.measure("peak", signal="R_M")},
        workers=1,
        **moved,
    )
    claimed = td.study(
        compensated,
        {"level": [0.3, 0.5, 0.7], "friction": [0.4, 0.6]},
        measures="claim",
        workers=1,
    )
    return {
        "grid": _dataset(grid.data),
        "sensitivities": _dataset(drawn.sensitivity()),
        "latin hypercube": _dataset(cube.data),
        "claims": _dataset(claimed.data),
    }


def compensated(level: float, friction: float) -> Any:
    """The claim about a Dahl compensator beside ideal friction."""
    return td.passivity.dahl_compensation(
        coulomb_level=friction, compensator_level=level, compensator_stiffness=1e4
    )


def _many() -> dict[str, Any]:
    cancel, _ = controllers()
    diagram = td.haptic_interface(device(COULOMB, SOFT, VISCOUS), cancellation=cancel)
    values = {
        "Z_M.coulomb.level": np.array([0.0, 0.2, 0.5, 0.8]),
        "Z_M.presliding.stiffness": np.array([1e4, 2e4, 5e4, 1e5]),
        "Z_M.inertia": np.array([0.1, 0.15, 0.2, 0.3]),
    }
    many = td.simulate_many(
        diagram,
        values,
        duration=0.2,
        inputs={"R_V": td.sine(amplitude=2.0, frequency=4.0)},
        reduce={"end": ("L", "final"), "peak": ("R_M", "peak"), "rms": ("L", "rms")},
    )
    return _dataset(many)


def _tuned() -> dict[str, Any]:
    law = td.controller("low_pass", {"bandwidth": 20.0})
    law = law.then(td.controller("gain", {"gain": 0.2}))
    loop = td.haptic_interface(device(("viscous", {"damping": 4.0})), force_feedback=law)
    most = {"H.gain.gain": (0.01, 5.0)}
    both = {"H.gain.gain": (0.05, 20.0), "H.low_pass.bandwidth": (2.0, 50.0)}
    best = td.tune(loop, most, less_gain, subject_to=["passive"], evaluations=80)
    front = td.trade_off(
        loop, both, [less_gain, slowness], subject_to=["passive"], evaluations=60, points=4
    )
    true = td.haptic_interface(device(VISCOUS, ("spring", {"stiffness": 300.0})))
    pushed = {"inputs": {"R_V": td.sine(amplitude=2.0, frequency=4.0)}}
    data = td.simulate_diagram(true, duration=0.4, **pushed).data
    noise = 1e-5 * np.random.default_rng(3).standard_normal(data.sizes["time"])
    measured = {"time": data["time"].values, "L": data["L"].values + noise}
    other = true.with_values({"Z_M.inertia": 0.2, "Z_M.spring.stiffness": 200.0})
    ranges = {"Z_M.inertia": (0.05, 0.5), "Z_M.spring.stiffness": (50.0, 1e3)}
    fitted = td.fit_simulation(other, measured, ranges, **pushed)
    return {
        "tuned": {
            "values": dict(best.values),
            "limits": [[each.how, bool(each.active)] for each in best.limits],
        },
        "trade-off": [dict(point.values) for point in front.points],
        "fit of a simulation": {
            name: {"value": fitted.values[name], "stderr": fitted.errors[name]}
            for name in sorted(fitted.values)
        },
    }


def _dataset(data: Any) -> dict[str, Any]:
    """Numbers and texts of a labelled data set; versions and hashes of code are no results."""
    content = {}
    for name in sorted(map(str, data.data_vars)):
        values = np.asarray(data[name].values)
        content[name] = values.tolist() if values.dtype.kind in "fiubU" else values.astype(str)
        if not isinstance(content[name], list | float | int | bool | str):
            content[name] = content[name].tolist()
    return content


# -- pages, results of commands, logs -------------------------------------------------------------


def pages() -> dict[str, Any]:
    """What commands print for the example that ships with the package."""
    rod = str(td.example("rod"))
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
        status, output, errors = command(words)
        text = TIMED.sub("", (output if status == 0 else output + errors).replace(rod, "rod"))
        name = " ".join("rod" if word == rod else word for word in words)
        texts[name] = {"status": status, "text": text.replace(str(ROOT), "").splitlines()}
    return texts


def results() -> dict[str, Any]:
    """What commands save of the example: the answer, and what is made of it."""
    rod = str(td.example("rod"))
    made: dict[str, Any] = {}
    with tempfile.TemporaryDirectory() as scratch:
        answer = str(Path(scratch) / "answer.json")
        command(["diagnose", rod, "--json", answer])
        made["diagnose"] = json.loads(Path(answer).read_text(encoding="utf-8"))
        for name, more in {
            "design": (),
            "describe": (),
            "next": (),
            "passivity": ("--dahl", "0.3", "20000", "--period", "0.001"),
        }.items():
            path = Path(scratch) / f"{name}.json"
            status, _, errors = command([name, rod, "--answer", answer, *more, "--json", str(path)])
            made[name] = (
                json.loads(path.read_text(encoding="utf-8"))
                if status == 0
                else {"status": status, "said": errors.strip()}
            )
    return {name: _without_places(content) for name, content in made.items()}


def _without_places(content: Any) -> Any:
    """Without the folder that a file was read from, and the version that wrote it."""
    if isinstance(content, dict):
        left_out = ("folder", "version", "teleopdesign", "written")
        return {k: _without_places(v) for k, v in content.items() if k not in left_out}
    return [_without_places(v) for v in content] if isinstance(content, list) else content


def logs() -> dict[str, Any]:
    """What is read of every log of the corpus of the tests, whatever its entry states."""
    sys.path[:0] = [str(ROOT / "tests")]
    from corpus.reading import entries

    names = sorted(entries())
    with ProcessPoolExecutor(max_workers=2) as pool:
        return dict(zip(names, pool.map(_log, names, chunksize=8), strict=True))


def _log(name: str) -> dict[str, Any]:
    sys.path[:0] = [str(ROOT / "tests")]
    from corpus.reading import entries, read, unpacked

    entry = entries()[name]
    with tempfile.TemporaryDirectory() as scratch:
        logs = unpacked(entry, Path(scratch))
        reading = read(logs, entry.get("options", []), Path(scratch) / "made")
        if reading.refused:
            return {"refused": reading.refused.replace(scratch, "")}
    return {
        "axis": reading.axis,
        "channels": dict(reading.channels),
        "guessed": sorted(key.removeprefix("channels.") for key in reading.guessed),
        "signals": {k: list(v) for k, v in reading.at.items()},
        "records": list(reading.records),
        "sample_time": reading.sample_time,
        "duration": reading.duration,
    }


PARTS: dict[str, Callable[[], dict[str, Any]]] = {
    "derivations": derivations,
    "responses": responses,
    "simulations": simulations,
    "claims": claims,
    "studies": studies,
    "pages": pages,
    "results": results,
    "logs": logs,
}
