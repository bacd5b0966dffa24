"""Writes a case: experiment.toml, fit.csv.gz, check.csv.gz and the truth."""

from __future__ import annotations

import gzip
import json
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from truth_effects import PUBLIC, UNITS

if TYPE_CHECKING:
    from cases import Case


def _quantity(value: float, unit: str, more: str = "") -> str:
    return f'{{ value = {value:.4g}, unit = "{unit}"{more} }}'


def experiment_text(case: Case) -> str:
    m = case.machine
    units = UNITS[m.axis]
    kind = {"prismatic": "Linear", "revolute": "Rotary"}[m.axis]
    lines = [f'title = "{kind} {m.kind}, drawn case {case.name}"', ""]
    for i, b in enumerate(m.bodies):
        start = case.start[i]
        fixed = m.fixed_inertia[i]
        inertia = f"{start['inertia']:.10g}" if fixed else f"{start['inertia']:.4g}"
        lines += [
            f"[model.{b}]",
            f'axis = "{m.axis}"',
            f'inertia = {{ value = {inertia}, unit = "{units["inertia"]}", '
            f"fixed = {str(fixed).lower()} }}",
            f"[model.{b}.effects]",
        ]
        for e in m.in_model[i]:
            if e in ("spring", "bias", "stribeck") and case.machine.noise_seed % 2:
                lines.append(f"{e} = {{}}")
                continue
            inner = ", ".join(
                f"{public} = {_quantity(start[key], units[unit])}"
                for public, (key, unit) in PUBLIC[e].items()
            )
            lines.append(f"{e} = {{ {inner} }}")
        lines.append("")
    if m.contact:
        s = case.start[1]
        stiffness = s["contact_stiffness"]
        power = case.values[1].get("contact_power", 1.0)
        if power != 1.0:  # a linear contact of the same force at a typical depth
            stiffness *= m.scales[1].size ** (power - 1)
        lines += [
            "[model.environment]",
            f"stiffness = {_quantity(stiffness, units['stiffness'])}",
            f"contact_position = {_quantity(s['contact_position'], units['length'])}",
            "",
        ]
    lines += ["[channels]", 'time = { column = "t", unit = "s" }']
    for i, b in enumerate(m.bodies):
        one = len(m.bodies) == 1
        q = (lambda n: n) if one else (lambda n, b=b: f'"{b}.{n}"')
        end = "" if one else f"_{b[0]}"
        res = case.values[i]["resolution"]
        lines.append(f'{q("actuator_force")} = {{ column = "u{end}", unit = "{units["force"]}" }}')
        lines.append(
            f'{q("position")} = {{ column = "x{end}", unit = "{units["length"]}", '
            f"resolution = {res:.6g} }}"
        )
        if m.sensors[i]:
            name = "f_h" if one else f"f{end}"
            lines.append(
                f'{q("interaction_force")} = {{ column = "{name}", unit = "{units["force"]}", '
                f"noise = {m.noise[i]:.4g} }}"
            )
    lines += ["", "[comparison]", f'bandwidth = {{ value = {m.bandwidth:g}, unit = "Hz" }}', ""]
    for r in ("fit", "check"):
        lines += ["[[records]]", f'file = "{r}.csv.gz"', f'use = "{r}"']
    return "\n".join(lines) + "\n"


def record_text(case: Case, name: str) -> str:
    m = case.machine
    head, columns, forms = ["t"], [], []
    tracks = case.tracks[name]
    n = len(tracks[0].command)
    columns.append(np.arange(n) / m.rate)
    forms.append("%.4f" if m.rate > 1000 else "%.3f")
    for i, b in enumerate(m.bodies):
        one = len(m.bodies) == 1
        end = "" if one else f"_{b[0]}"
        t = tracks[i]
        digits = -math.floor(math.log10(case.values[i]["command_step"]) + 0.5)
        head += [f"u{end}", f"x{end}"]
        columns += [t.command, t.position]
        forms += [f"%.{max(digits, 0)}f", f"%.{2 - math.floor(math.log10(t.resolution))}f"]
        if m.sensors[i]:
            head.append("f_h" if one else f"f{end}")
            columns.append(t.sensed)
            forms.append(f"%.{max(0, 2 - math.floor(math.log10(t.noise)))}f")
    form = ",".join(forms)
    table = np.column_stack(columns).tolist()
    rows = [form % tuple(row) for row in table]
    return ",".join(head) + "\n" + "\n".join(rows) + "\n"


def write_files(case: Case, folder: Path, truth: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    truth.parent.mkdir(parents=True, exist_ok=True)
    (folder / "experiment.toml").write_text(experiment_text(case))
    for name in ("fit", "check"):
        raw = record_text(case, name).encode()
        (folder / f"{name}.csv.gz").write_bytes(gzip.compress(raw, 5, mtime=0))
    truth.write_text(json.dumps(case.truth(), indent=1) + "\n")
