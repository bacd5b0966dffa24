"""Random cases with a hidden effect, and the command line that writes them.

    python tests/hidden/cases.py --folder DIR --number 60 --seed 1 --levels clear,weak,null

DIR/cases/NNN holds what a user would have, DIR/truth/NNN.json what the machine was.  How strong an
effect is, is set by simulation and a re-estimate of the user's model: see reference.py for what
those figures approximate.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from case_writer import write_files
from excitation import RICHNESS
from look_alikes import groups
from machines import Machine, hard_stiffness, make_machine, run_machine
from reference import Parameters, Track, figure, refit
from truth_effects import (
    CONTACT,
    NEEDS_LEVEL,
    NO_INVERSE,
    OTHERS,
    OUTSIDE,
    PUBLIC,
    REVOLUTE,
    TEN,
    UNITS,
    Values,
    draw,
    shape,
)

LEVELS = ("clear", "weak", "null", "double", "outside")
WINDOW = {"clear": (4.0, 60.0), "weak": (1.6, 3.0), "double": (4.0, 60.0), "outside": (4.0, 60.0)}
AIM = {"clear": (4.5, 20.0), "weak": (1.8, 2.7), "double": (5.5, 15.0), "outside": (4.5, 15.0)}
START = {
    "bias": 0.1, "coulomb_asymmetry": 0.1, "actuation_delay": 0.2, "actuator_lag": 0.2,
    "contact_damping": 0.2, "contact_hardening": 0.2,
}  # fmt: skip


@dataclass
class Hidden:
    effect: str
    body: int
    at: str
    shape: Values
    strength: float = 0.3


@dataclass
class Case:
    level: str
    machine: Machine
    hidden: list[Hidden]
    values: list[Values]
    tracks: dict[str, list[Track]]
    figures: dict[str, object]
    start: list[Values] = field(default_factory=list)  # what the user believes, a body each
    name: str = "000"

    def truth(self) -> dict[str, object]:
        """The truth file."""
        m = self.machine
        units = UNITS[m.axis]
        effects = []
        for h in self.hidden:
            v = self.values[h.body]
            shown = {
                public: {"value": v[key], "unit": units[kind]}
                for public, (key, kind) in PUBLIC[h.effect].items()
            }
            effects.append({"effect": h.effect, "at": h.at, "parameters": shown})
        parameters: dict[str, float] = {}
        for i, b in enumerate(m.bodies):
            parameters[f"{b}.inertia"] = self.values[i]["inertia"]
            for e in m.in_model[i]:
                for public, (key, _) in PUBLIC[e].items():
                    parameters[f"{b}.{e}.{public}"] = self.values[i][key]
        if m.contact:
            parameters["environment.stiffness"] = self.values[1]["contact_stiffness"]
            parameters["environment.contact_position"] = self.values[1]["contact_position"]
        head = {"case": self.name, "level": self.level, "kind": m.kind, "axis": m.axis}
        return head | {"effects": effects} | self.figures | {"model_parameters": parameters}


def free_parameters(machine: Machine, i: int, added: list[str]) -> list[str]:
    free = [] if machine.fixed_inertia[i] else ["inertia"]
    for e in [*machine.in_model[i], *added]:
        free += [key for key, _ in PUBLIC[e].values()]
    if machine.contact and i == 1:
        free += ["contact_stiffness", "contact_position"]
    return free


def model_of(machine: Machine, values: Values, i: int, added: list[str]) -> Parameters:
    """The user's model of body i, at the true values, with some effects added."""
    keep = {"inertia": values["inertia"], "bristle_stiffness": hard_stiffness(values)}
    for n in free_parameters(machine, i, added):
        keep[n] = values[n]
    return keep


def base_error(
    machine: Machine,
    values: list[Values],
    tracks: dict[str, list[Track]],
    added: list[list[str]],
    steps: int = 8,
) -> tuple[float, float]:
    """Fit and check error of the user's model (and the added effects), re-estimated."""
    fitted = []
    for i, v in enumerate(values):
        p = model_of(machine, v, i, added[i])
        fitted.append(refit(tracks["fit"][i], p, free_parameters(machine, i, added[i]), steps))
    both = [
        figure(tr, [t.residual(p) for t, p in zip(tr, fitted, strict=False)])
        for tr in tracks.values()
    ]
    return both[0], both[1]


def floor(tracks: list[Track], values: list[Values], seed: int) -> float:
    rng = np.random.default_rng(seed)
    drawn = [
        figure(tracks, [t.noise_only(v, rng) for t, v in zip(tracks, values, strict=False)])
        for _ in range(3)
    ]
    return float(np.sqrt(np.mean(np.square(drawn))))


def _with(machine: Machine, hidden: list[Hidden]) -> list[Values]:
    values = [dict(v) for v in machine.values]
    for h in hidden:
        values[h.body] |= draw(
            h.effect, values[h.body], machine.scales[h.body], h.strength, h.shape
        )
    return values


def _place(rng: np.random.Generator, machine: Machine, effect: str) -> Hidden:
    if effect in CONTACT:
        return Hidden(effect, 1, "environment", shape(rng))
    i = int(rng.integers(len(machine.bodies)))
    if effect in ("actuator_gain", "added_inertia"):
        i = 0
    return Hidden(effect, i, machine.bodies[i], shape(rng))


def _prepare(rng: np.random.Generator, machine: Machine, hidden: list[Hidden]) -> None:
    """The user's model: without the hidden effects, at times with others; a fixed inertia."""
    for h in hidden:
        model = machine.in_model[h.body]
        if h.effect in model:
            model.remove(h.effect)
        if h.effect == "added_inertia":
            machine.fixed_inertia[h.body] = True
        h.strength = START.get(h.effect, 0.3)
    names = {h.effect for h in hidden}
    for i, v in enumerate(machine.values):
        for name in ("spring", "bias", "stribeck"):
            wanted = name == "stribeck" and any(
                h.effect == "friction_memory" and h.body == i for h in hidden
            )
            clash = name in names or (name == "bias" and "coulomb_asymmetry" in names)
            clash |= "coulomb" not in machine.in_model[i] and name == "stribeck"
            clash |= "presliding" in names and name == "stribeck"
            if not wanted and (clash or rng.random() > 0.12):
                continue
            strength = rng.uniform(0.3, 0.8) if wanted else rng.uniform(0.1, 0.4)
            v |= draw(name, v, machine.scales[i], float(strength), shape(rng))
            machine.in_model[i].append(name)
        if not machine.fixed_inertia[i] and rng.random() < 0.1:
            machine.fixed_inertia[i] = True
    if "actuator_gain" in names and not machine.sensors[0]:
        machine.fixed_inertia[0] = True
    for h in hidden:  # the hidden effect replaces what the machine had of it
        for key, _ in PUBLIC[h.effect].values():
            if h.effect in ("viscous", "coulomb"):
                machine.values[h.body].pop(key, None)


def _choose(rng: np.random.Generator, level: str, kind: str) -> list[str]:
    if level == "null":
        return []
    if level == "outside":
        return [str(rng.choice(OUTSIDE))]
    pool = [*TEN, *OTHERS, *(CONTACT if kind == "teleoperator" else ())]
    if level == "double":
        pool = [e for e in pool if e not in NO_INVERSE]
        while True:
            a, b = (str(e) for e in rng.choice(pool, 2, replace=False))
            pair = {a, b}
            if pair in ({"bias", "coulomb_asymmetry"}, {"actuation_delay", "actuator_lag"}):
                continue
            if "coulomb" in pair and pair & NEEDS_LEVEL or pair == {"viscous", "viscous_asymmetry"}:
                continue
            if pair == {"added_inertia", "actuator_gain"}:
                continue
            return [a, b]
    return [str(rng.choice(pool))]


def _left(machine: Machine, hidden: list[Hidden], without: int | None) -> list[list[str]]:
    """Effects added to the model of each body when one (None: all) of the hidden is left out."""
    added: list[list[str]] = [[] for _ in machine.bodies]
    if without is not None:
        for j, h in enumerate(hidden):
            if j != without:
                added[h.body].append(h.effect)
    return added


def _scale_strengths(
    rng: np.random.Generator, level: str, machine: Machine, hidden: list[Hidden]
) -> bool:
    """Search strengths that meet the level, with coarser steps; False if none does."""
    low, high = AIM[level]
    aims = np.exp(rng.uniform(np.log(low), np.log(high), len(hidden)))
    for _ in range(5):
        values = _with(machine, hidden)
        try:
            tracks = run_machine(machine, values, 50e-6)
        except FloatingPointError:
            return False
        if (
            max(
                np.abs(t.x).max() / s.size
                for t, s in zip(tracks["check"], machine.scales, strict=False)
            )
            > 12
        ):
            return False
        base = floor(tracks["check"], values, machine.noise_seed)
        good = True
        for j, h in enumerate(hidden):
            added = _left(machine, hidden, j)
            ratio = base_error(machine, values, tracks, added)[1] / base
            inside = 0.97 * low < ratio < 1.05 * high
            good &= inside
            if not inside:
                grow = np.sqrt((aims[j] ** 2 - 1) / max(ratio**2 - 1, 0.05))
                new = h.strength * float(np.clip(grow, 0.15, 4.0))
                if h.strength >= 1.0 and new > 1.0:
                    return False
                h.strength = min(new, 1.0)
        if good:
            return True
    return False


def make_case(
    rng: np.random.Generator,
    level: str,
    effects: list[str] | None = None,
    kind: str = "device",
    excitation: str = "normal",
    rate: float = 1000.0,
    hand: bool | None = None,
    tries: int = 12,
) -> Case:
    """A random case of a level; `effects`: those hidden, `hand`: whether its force is a channel."""
    for _ in range(tries):
        names = list(effects) if effects is not None else _choose(rng, level, kind)
        touch = kind == "teleoperator" and (bool(set(names) & set(CONTACT)) or rng.random() < 0.3)
        held = True if {"added_inertia", "actuator_gain"} & set(names) else hand
        turns = bool(REVOLUTE & set(names))
        machine = make_machine(rng, kind, excitation, rate, held, touch, turns)
        hidden = [_place(rng, machine, e) for e in names]
        _prepare(rng, machine, hidden)
        if hidden and not _scale_strengths(rng, level, machine, hidden):
            continue
        values = _with(machine, hidden)
        tracks = run_machine(machine, values)
        base = floor(tracks["check"], values, machine.noise_seed + 1)
        fit, check = base_error(machine, values, tracks, _left(machine, hidden, None))
        ratio = check / base
        alone: list[float] = []
        if level == "double":
            alone = [
                base_error(machine, values, tracks, _left(machine, hidden, j))[1] / base
                for j in range(len(hidden))
            ]
        low, high = WINDOW.get(level, (0.0, 1.3))
        if not all(low <= r <= high for r in (alone or [ratio])):
            continue
        true = figure(
            tracks["check"],
            [t.noise_only(v) for t, v in zip(tracks["check"], values, strict=False)],
        )
        figures: dict[str, object] = {
            "indistinguishable": groups(
                machine,
                hidden,
                values,
                error=lambda v, added, steps, tr=tracks, m=machine: base_error(
                    m, v, tr, added, steps
                )[1],
                true=true,
                excitation=excitation,
            ),
            "check_error_base": round(check, 6),
            "fit_error_base": round(fit, 6),
            "check_error_true": round(true, 6),
            "noise_floor": round(base, 6),
            "ratio": round(ratio, 3),
            "bandwidth": machine.bandwidth,
        }
        if alone:
            figures["ratio_without_one"] = [round(r, 3) for r in alone]
        if hidden:
            figures["strength"] = [round(h.strength, 4) for h in hidden]
        return Case(
            level, machine, hidden, values, tracks, figures, _believed(rng, machine, values)
        )
    raise RuntimeError(f"no machine with {effects or level} at level {level} in {tries} tries")


def _believed(rng: np.random.Generator, machine: Machine, values: list[Values]) -> list[Values]:
    """Starting values, wrong by up to 20 %; a fixed inertia is right."""
    out = []
    for i, v in enumerate(values):
        start = {n: v[n] * float(rng.uniform(0.8, 1.2)) for n in free_parameters(machine, i, [])}
        start.setdefault("inertia", v["inertia"])
        if "contact_position" in start:
            start["contact_position"] = v["contact_position"] * float(rng.uniform(0.9, 1.1))
        out.append(start)
    return out


def write_case(case: Case, folder: Path) -> None:
    """experiment.toml, the two records and truth.json in one folder."""
    write_files(case, folder, folder / "truth.json")


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--number", type=int, default=10)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument(
        "--levels", default="clear,weak,null", help=f"in turn, of {','.join(LEVELS)}"
    )
    parser.add_argument("--effects", help="drawn from these in turn (default: all); also `ten`")
    parser.add_argument("--kind", default="device", choices=["device", "teleoperator", "both"])
    parser.add_argument("--excitation", default="normal", choices=RICHNESS)
    parser.add_argument("--rate", type=float, default=1000.0)
    a = parser.parse_args(arguments)
    levels = a.levels.split(",")
    pool = list(TEN) if a.effects == "ten" else a.effects.split(",") if a.effects else []
    turn = 0
    for k in range(a.number):
        rng = np.random.default_rng([a.seed, k])
        level = levels[k % len(levels)]
        kind = ("device", "teleoperator")[k % 2] if a.kind == "both" else a.kind
        effects: list[str] | None = None
        if pool and level in ("clear", "weak"):
            effects = [pool[turn % len(pool)]]
            turn += 1
        began = time.perf_counter()
        try:
            case = make_case(rng, level, effects, kind, a.excitation, a.rate)
        except RuntimeError as e:
            print(f"{k + 1:03d} skipped: {e}", file=sys.stderr)
            continue
        case.name = f"{k + 1:03d}"
        folder, truth = a.folder / "cases" / case.name, a.folder / "truth" / f"{case.name}.json"
        write_files(case, folder, truth)
        shown = "+".join(f"{h.effect}@{h.at}" for h in case.hidden) or "-"
        spent = time.perf_counter() - began
        print(
            f"{case.name} {level:8s} {shown:40s} {case.figures['ratio']:7.2f} floors {spent:5.1f} s"
        )
    return 0


if __name__ == "__main__":
    sys.exit(main())
