"""From a raw log to a compensation to a second log with it on, on devices of a simulator.

    PYTHONPATH=tests python -m design.closed_loop_campaign FOLDER [--devices 60] [--first 0]

Each device is drawn with one effect beside Coulomb and viscous friction. Its raw log goes through
`new`, a diagnosis among `AMONG`, and a design, whose map of impedances and claims over motions are
left small, since nothing here reads them. The design's numbers, with the cancellation alone, are
switched on in the simulator, and the second log goes through `new` and `verify`. A row a device
goes to FOLDER/rows_FIRST.csv: effect, verdict, names, ends of the predicted interval, measured and
uncompensated force error, and what `verify` names. `closed_loop.csv` beside this file holds the
rows of the last run.
"""

import argparse
import contextlib
import csv
import io
import json
import time
from pathlib import Path

import numpy as np
from design.compensated_joint import compensation_of, record, record_without

import teleopdesign as td
from teleopdesign.cli import main as command
from teleopdesign.design import prediction, verdict
from teleopdesign.design.verify import read_plan, verify

SECONDS = 12
#: effect -> its parameters, drawn between two ends
EFFECTS = {
    "cogging": {"amplitude": (0.06, 0.15), "period": (0.3, 0.7), "phase": (0, 6.28)},
    "gravity": {"amplitude": (0.2, 0.5), "phase": (0, 6.28)},
    "stribeck": {"extra_static_level": (0.06, 0.15), "stribeck_velocity": (0.1, 0.4)},
    "coulomb_asymmetry": {"half_difference": (0.03, 0.08)},
    "viscous_asymmetry": {"half_difference": (0.015, 0.04)},
    "position_dependent_friction": {
        "amplitude": (0.25, 0.5), "period": (0.5, 1.2), "phase": (0, 6.28)
    },
    "load_dependent_friction": {"coefficient": (0.1, 0.3)},
    "bias": {"force": (0.08, 0.2)},
    "spring": {"stiffness": (0.2, 0.6)},
    "hardening_spring": {"stiffness": (0.2, 0.6)},
    "quadratic_drag": {"drag": (0.01, 0.03)},
    "torque_ripple": {"amplitude": (0.1, 0.25), "period": (0.3, 0.7), "phase": (0, 6.28)},
}  # fmt: skip
#: candidates of the diagnosis: these, and what looks like them
AMONG = (
    *EFFECTS,
    *("presliding", "actuation_delay", "actuator_lag", "actuator_gain", "friction_drift"),
    *("shear_thinning", "cogging_harmonic", "friction_memory"),
)


def keep_small(put=setattr):
    """Few motions in the claims and in the map of impedances; put: sets an attribute."""
    put(verdict, "SIZES", (1.0,))
    put(verdict, "FREQUENCIES", (1.0, 10.0))
    put(prediction, "MULTIPLES", (1.0,))


def draw_device(number):
    """Inertia, effects and the name of the one that is beside friction."""
    random = np.random.default_rng([56, number])
    name = list(EFFECTS)[number % len(EFFECTS)]
    inertia = random.uniform(0.008, 0.016)
    effects = {
        "coulomb": {"level": random.uniform(0.15, 0.3)},
        "viscous": {"damping": random.uniform(0.02, 0.06)},
        name: {p: random.uniform(*ends) for p, ends in EFFECTS[name].items()},
    }
    return inertia, effects, name, random


def write_log(path, columns):
    """A raw log as a logger writes it."""
    rows = np.column_stack(list(columns.values()))
    head = "Time (s),Angle (rad),Torque command (Nm),Hand torque (Nm)"
    np.savetxt(path, rows, fmt="%.7g", delimiter=",", header=head, comments="")


def run(*words):
    """A command of the package, whose words are kept."""
    text = io.StringIO()
    with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
        status = command([str(w) for w in words])
    if status:
        raise RuntimeError(f"{words[0]}: {text.getvalue().strip().splitlines()[-1]}")
    return text.getvalue()


def close_the_loop(number, folder, among=AMONG):
    """One device: from its raw log to the second log; the row of the table."""
    inertia, effects, name, random = draw_device(number)
    place = Path(folder) / f"{number:03}"
    place.mkdir(parents=True, exist_ok=True)
    file = place / "design.json"
    write_log(place / "off.csv", record_without(inertia, effects, SECONDS, random))
    run("new", place / "off.csv", "--yes", "--overwrite", "--output", place / "off")
    diagnosis = td.find_missing(td.load_experiment(place / "off"), among=among)
    td.design_compensation(diagnosis).to_json(file)
    design = json.loads(file.read_text())
    case = "MBC" if design["cancellation"] else "FF"
    computer = compensation_of(design, case=case)
    write_log(place / "on.csv", record(inertia, effects, computer, SECONDS, random))
    run("new", place / "on.csv", "--yes", "--overwrite", "--output", place / "on")
    verified = verify(read_plan(file), td.load_experiment(place / "on"), case=case)
    return {
        "device": number,
        "effect": name,
        "verdict": diagnosis.verdict,
        "missing": " ".join(one.effect.name for one in diagnosis.missing),
        "law": " ".join(design["cancellation"]["laws"]) if design["cancellation"] else "",
        "case": case,
        "low": f"{verified.low:.4g}",
        "high": f"{verified.high:.4g}",
        "measured": f"{verified.measured:.4g}",
        "without": f"{verified.without:.4g}",
        "holds": int(verified.holds),
        "named": "; ".join(" or ".join(map(str, group)) for group in verified.deviations),
    }


def summary(rows):
    """How many intervals hold, and their median width over the error."""
    widths = [(float(r["high"]) - float(r["low"])) / float(r["measured"]) for r in rows]
    held = sum(int(r["holds"]) for r in rows)
    return f"{held} of {len(rows)} hold, median width {100 * float(np.median(widths)):.0f} %"


def main(folder, devices, first):
    keep_small()
    path = Path(folder) / f"rows_{first:03}.csv"
    rows = []
    for number in range(first, devices):
        begin = time.time()
        try:
            row = close_the_loop(number, folder)
        except RuntimeError as error:
            print(number, error, flush=True)
            continue
        rows.append(row)
        with path.open("w", newline="") as file:
            writer = csv.DictWriter(file, list(row))
            writer.writeheader()
            writer.writerows(rows)
        print(*row.values(), f"{time.time() - begin:.0f} s", flush=True)
        print(summary(rows), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--devices", type=int, default=60)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    main(options.folder, options.devices, options.first)
