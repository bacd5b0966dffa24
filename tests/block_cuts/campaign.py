"""Right and false names on drawn interfaces and teleoperators, with one hidden effect or none.

    PYTHONPATH=tests python -m block_cuts.campaign FOLDER --level clear|weak|adequate [--first 0]
        [--without R_A]

Each hidden effect of `HIDDEN` is planted once, in a diagram of its own; `weak` has a quarter of its
size. A row a case is added to `campaign.csv` beside this file. Of effects in the computer only the
cuts of the computer are compared, of those in a body only its cut, since all signals between
were recorded: what is planted on one side of a cut changes nothing on the other. Where nothing is
planted, all cuts are compared. `--without` leaves a signal out of the records of interfaces.
    PYTHONPATH=tests python -m block_cuts.campaign --table       what the file says
"""

import argparse
import csv
import json
from pathlib import Path

import numpy as np
from block_cuts.interface_simulator import draw_interface, leave_out, write_case
from block_cuts.teleoperator_simulator import draw_teleoperator, write_teleoperator

import teleopdesign as td

TABLE = Path(__file__).with_suffix(".csv")
FIELDS = (
    "level",
    "number",
    "planted",
    "right",
    "false",
    "verdict",
    "missing",
    "groups",
    "probabilities",
    "error",
)
HIDDEN = [
    ("gain", "H", 1.06), ("delay", "H", 0.004), ("lag", "H", 0.004),
    ("saturation", "H", 1.2), ("dead_zone", "H", 0.05), ("velocity_filter", "H", 0.006),
    ("gain", "C", 0.9), ("delay", "C", 0.003), ("velocity_filter", "C", 0.005),
    ("bias", "C", 0.02), ("gain", "K", 1.06), ("delay", "K", 0.004),
    ("gain", "computer", 1.04), ("delay", "computer", 0.003), ("lag", "computer", 0.003),
    ("dead_zone", "computer", 0.06),
    ("stribeck", "Z_M", 0.15), ("quadratic_drag", "Z_M", 6.0), ("bias", "Z_M", 0.12),
    ("hardening_spring", "Z_H", 1.5e6), ("viscous_asymmetry", "Z_H", 0.6),
    ("delay", "P", 0.003), ("gain", "P", 1.05), ("velocity_filter", "C_m", 0.005),
    ("lag", "C_s", 0.004),
    ("quadratic_drag", "Z_m", 6.0), ("quadratic_drag", "Z_s", 6.0), ("bias", "Z_s", 0.12),
]  # fmt: skip
#: weak sizes that are no quarter: a limit below the largest output, and more than one row of delay,
#: because a shift of a row belongs to the record
WEAK = {("saturation", "H"): 0.75, ("delay", "computer"): 0.002}
#: number of diagrams with nothing planted; each third one is a teleoperator
ADEQUATE = 30
#: edges of the bins of a calibration, as probabilities
BINS = (0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 0.95, 1.0 + 1e-9)


def cases(level):
    """(hidden, is a teleoperator) of each case of a level."""
    if level == "adequate":
        return [({}, number % 3 == 2) for number in range(ADEQUATE)]
    size = 1.0 if level == "clear" else 0.25
    made = []
    for effect, at, value in HIDDEN:
        absent = 1.0 if effect == "gain" else 0.0
        less = absent + size * (value - absent)
        if level == "weak":
            less = WEAK.get((effect, at), less)
        made.append(({(effect, at): less}, at in ("P", "C_m", "C_s", "Z_m", "Z_s")))
    return made


def judge(diagnosis, hidden):
    """Whether the answer is right: the effect named, or listed in a group of its like."""
    if not hidden:
        return diagnosis.verdict == "model_adequate"
    (true,) = hidden
    listed = any(true in group for group in diagnosis.groups)
    return diagnosis.missing == (true,) or (not diagnosis.missing and listed)


def error_of_cut(diagnosis, hidden):
    """Last error of the cut of the planted effect, over that of the true structure or the floor.

    The true structure is the diagram with the planted effect alone, estimated again: a candidate.
    """
    ratios = []
    for effect, at in hidden:
        for name, body in diagnosis.bodies.items():
            if name == at:
                ratios += _ratio_of_body(body, effect, diagnosis.rows[-1].check[name])
        for ladder in diagnosis.ladders:
            for one in ladder.steps[0].attempts:
                if one.added.key == (effect, at):
                    errors = one.fit.errors["check"]
                    ratios += [
                        diagnosis.rows[-1].check[n] / max(e, diagnosis.floors[n])
                        for n, e in errors.items()
                    ]
    return max(ratios, default=None)


def _ratio_of_body(body, effect, last):
    """The same of a body's cut; the true structure is a candidate of the stated model."""
    true = [r for r in body.candidates if r.candidate.effect.name == effect]
    return [last / max(r.check_error, body.floor.value) for r in true]


def diagnose(level, number, hidden, of_two, place, without=None):
    """Write the case, and diagnose it;  without: a signal that is not recorded."""
    random = np.random.default_rng([("clear", "weak", "adequate").index(level), number])
    if of_two:
        teleoperator = draw_teleoperator(random)
        teleoperator.hidden = hidden
        write_teleoperator(teleoperator, place, random)
    else:
        interface = draw_interface(random)
        interface.hidden, interface.loop = hidden, any(at == "K" for _, at in hidden)
        write_case(interface, place, random)
        if without is not None:
            leave_out(place, without)
    experiment = td.load_experiment(place)
    touched = {at for _, at in hidden}
    cuts = experiment.cuts.tested
    kinds = {c.kind for c in cuts if touched & set(c.blocks)}
    bodies = [c.name for c in cuts if c.kind == "body" and touched & set(c.blocks)]
    at = bodies or [c.name for c in cuts if c.kind in kinds] or None
    return td.find_missing(experiment, at=at)


def run(folder, level, first, last, without=None):
    for number, (hidden, of_two) in list(enumerate(cases(level)))[first : last + 1]:
        if without is not None and of_two:
            continue
        place = Path(folder) / level / f"{number:03}"
        diagnosis = diagnose(level, number, hidden, of_two, place, without)
        probabilities = [
            [c["effect"], c["at"], round(c["probability"], 4)]
            for c in diagnosis.answer()["candidates"]
        ]
        row = {
            "level": level if without is None else f"{level} without {without}",
            "number": number, "planted": list(hidden.items()),
            "right": judge(diagnosis, hidden),
            "false": [key for key in diagnosis.missing if key not in hidden],
            "verdict": diagnosis.verdict, "missing": diagnosis.missing,
            "groups": diagnosis.groups, "probabilities": probabilities,
            "error": error_of_cut(diagnosis, hidden),
        }  # fmt: skip
        with TABLE.open("a", newline="") as file:
            csv.DictWriter(file, FIELDS, lineterminator="\n").writerow(
                {k: json.dumps(v) for k, v in row.items()}
            )
        print(*(f"{k} {v}" for k, v in row.items() if k != "probabilities"), flush=True)


def table():
    """Right and false names by level, and the calibration of every candidate's probability."""
    with TABLE.open() as file:
        rows = [{k: json.loads(v) for k, v in row.items()} for row in csv.DictReader(file, FIELDS)]
    for level in dict.fromkeys(r["level"] for r in rows):
        here = [r for r in rows if r["level"] == level]
        right, false = sum(r["right"] for r in here), sum(bool(r["false"]) for r in here)
        print(f"{level}: {right} of {len(here)} right, {false} with a false name")
        if errors := [r["error"] for r in here if r["error"] is not None]:
            print(f"  error over that of the true structure: at most {max(errors):.3f}")
    probabilities = np.array(
        [
            (p, (effect, at) in [tuple(key) for key, _ in r["planted"]])
            for r in rows
            for effect, at, p in r["probabilities"]
        ]
    )
    error = 0.0
    for low, high in zip(BINS[:-1], BINS[1:], strict=True):
        here = probabilities[(probabilities[:, 0] >= low) & (probabilities[:, 0] < high)]
        if len(here):
            p, share = here.mean(axis=0)
            error += len(here) / len(probabilities) * abs(p - share)
            print(
                f"probability {low:.2f} to {high:.2f}: {len(here)}, mean {p:.3f}, true {share:.3f}"
            )
    print(f"expected calibration error {error:.4f} over {len(probabilities)} candidates")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?")
    parser.add_argument("--level", choices=("clear", "weak", "adequate"))
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--last", type=int, default=99, help="number of the last case")
    parser.add_argument("--without", help="signal that is not recorded")
    parser.add_argument("--table", action="store_true", help="print what the file says")
    options = parser.parse_args()
    if options.table:
        table()
    else:
        run(options.folder, options.level, options.first, options.last, options.without)
