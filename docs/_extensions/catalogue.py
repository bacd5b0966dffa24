"""Tables and figures of speech printed from the code, so that no page repeats what a file says.

<!-- print: effects -->                      one section for each effect
<!-- print: controllers -->                  one section for each control law
<!-- print: effect_table -->                 one line for each effect
<!-- print: quantities -->                   quantities and units
<!-- print: constants MODULE ... -->         constants with the comment that stands above them
<!-- print: recordings -->                   public recordings
<!-- print: api MODULE -->                   the public names of a module
@{MODULE.NAME}, @{MODULE.CLASS.NAME}          the value of a constant, of a field
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

import sympy as sp
from docstrings import blocks
from sphinx.application import Sphinx
from sphinx.pycode import ModuleAnalyzer
from sympy.printing.latex import LatexPrinter, latex_escape

from teleopdesign.base.units import QUANTITIES, unit_of
from teleopdesign.controllers import CONTROLLERS
from teleopdesign.effects import EFFECTS, SIGNALS, Effect, Parameter
from teleopdesign.measurement.recordings import RECORDINGS

_SYMBOLS = {
    "time": "t",
    "position": "x",
    "velocity": "v",
    "acceleration": "a",
    "direction": r"\operatorname{sgn} v",
    "command": "u",
    "acting_force": r"f_{\mathrm{act}}",
    "level": r"F_{\mathrm{level}}",
    "temperature": "T",
    "other_acceleration": r"a_{\mathrm{other}}",
    "input": "e",
    "speed": r"\left|v\right|",
    "travel_rate": "v",
}
_LEFT = {
    "force": "F",
    "friction_level": r"\text{adds to } F_{\mathrm{level}}:\quad",
    "friction_factor": r"\text{multiplies } F_{\mathrm{level}}:\quad",
    "friction_speed": r"\left|v\right| \text{ in } F_{\mathrm{level}}",
    "friction_shape": r"F_{\mathrm{friction}}",
    "actuation": r"f_{\mathrm{out}}",
    "tip_level": r"\text{adds to the friction level of the tip}:\quad",
}
ROLE_TEXTS = {
    "actuation": "stands between the commanded force and the force that acts",
    "force": "a force that is subtracted in the equation of motion",
    "friction_level": "sets how large friction is; levels add up",
    "friction_factor": "multiplies the friction level",
    "friction_speed": "the speed that the friction level follows, in place of the body's own",
    "friction_shape": "sets how friction follows the motion; sgn v unless one is given",
    "tip_level": "dry friction of the tip behind a structure; levels add up",
    "contact": "a force of a modelled environment while it is touched; they add up and never pull",
    "contact_shape": "takes the place of the penetration in the spring of a modelled environment",
}
S = sp.Symbol("s")


class _Latex(LatexPrinter):
    def _print_Function(self, expr: Any, exp: Any = None) -> str:
        if expr.func.__name__ == "delayed":
            signal, delay = (self._print(a) for a in expr.args)
            return rf"{signal}\left(t - {delay}\right)"
        return str(super()._print_Function(expr, exp))


def latex(expression: sp.Expr, names: Mapping[sp.Symbol, str]) -> str:
    return str(_Latex({"symbol_names": dict(names)}).doprint(expression))


def parameter_symbol(name: str, parameter: Parameter) -> str:
    """The symbol that a parameter's meaning begins with ("F_C: ..."), as LaTeX."""
    head, colon, _ = parameter.meaning.partition(": ")
    if not colon or len(head) > 12 or " of " in head:
        return rf"\text{{{latex_escape(name)}}}"
    text = " ".join(_letter(word) for word in head.split())
    return rf"\left({text}\right)" if " " in head else text


def _letter(word: str) -> str:
    match = re.fullmatch(r"([A-Za-z]+)_(.+)", word)
    if match:
        base, index = match.groups()
        index = index if len(index) == 1 else rf"\mathrm{{{index}}}"
        return f"{_letter(base)}_{{{index}}}"
    return rf"\{word}" if word in ("tau", "sigma", "phi", "mu", "delta", "lambda") else word


def law_lines(effect: Effect) -> list[str]:
    """The law and the rates of its hidden states as the code has them, in LaTeX."""
    symbols = effect.symbols()
    names = {SIGNALS[n]: s for n, s in _SYMBOLS.items() if n in SIGNALS}
    names |= {symbols[n]: parameter_symbol(n, p) for n, p in effect.parameters.items()}
    states = effect.state_symbols()
    names |= {z: "z" if len(states) == 1 else rf"z_{{{i}}}" for i, z in enumerate(states.values())}
    left = _LEFT.get(effect.role, "F")
    equals = " " if left.endswith("quad") else " = "
    lines = [f"{left}{equals}{latex(effect.expression(), names)}"]
    for name, rate in effect.rates().items():
        lines.append(rf"\dot {{{names[states[name]]}}} = {latex(rate, names)}")
    return lines


def linear_line(effect: Effect) -> str:
    symbols = effect.symbols()
    names = {symbols[n]: parameter_symbol(n, p) for n, p in effect.parameters.items()}
    form = effect.linear_form(S)
    if form is None:
        return "Linear form: none declared; transfer functions leave it out and say so."
    what = "transfer function of the stage" if effect.role == "actuation" else "impedance"
    return f"Linear form, {what}: ${latex(form, names)}$."


def number(x: float) -> str:
    if x in (float("inf"), -float("inf")):
        return "∞" if x > 0 else "−∞"
    return f"{x:g}"


def table(head: list[str], body: list[list[str]]) -> str:
    lines = [head, ["---"] * len(head), *body]
    return "\n".join("| " + " | ".join(c.replace("|", r"\|") for c in row) + " |" for row in lines)


def parameter_table(parameters: Mapping[str, Parameter]) -> str:
    return table(
        ["parameter", "quantity", "prismatic", "revolute", "bounds (SI)", "meaning"],
        [
            [
                f"`{n}`",
                p.quantity.replace("_", " "),
                f"`{unit_of(p.quantity, 'prismatic')}`",
                f"`{unit_of(p.quantity, 'revolute')}`",
                f"{number(p.lower)} … {number(p.upper)}",
                plain(p.meaning),
            ]
            for n, p in parameters.items()
        ],
    )


def plain(text: str) -> str:
    """Text of a docstring as Markdown: names of effects become links."""
    parts = re.split(r"`([^`]+)`", text)
    out = ""
    for i, part in enumerate(parts):
        if i % 2:
            out += f"[`{part}`](#effect-{part})" if part in EFFECTS else f"`{part}`"
        else:
            out += re.sub(r"([\\*_|<>$])", r"\\\1", part)
    return out


def text_of(docstring: str) -> str:
    """A docstring without its first line, as Markdown."""
    _, _, rest = docstring.strip().partition("\n")
    out = []
    for kind, lines in blocks(rest):
        if kind == "code":
            out.append("\n".join(["```text", *lines, "```"]))
        else:
            out.append(plain(" ".join(line.strip() for line in lines)))
    return "\n\n".join(out)


def effects() -> str:
    parts = []
    roles = dict.fromkeys(e.role for e in EFFECTS.values())
    order = [r for r in ROLE_TEXTS if r in roles] + [r for r in roles if r not in ROLE_TEXTS]
    for role in order:
        text = ROLE_TEXTS.get(role, "")
        parts.append(f"## Role `{role}`\n\n{text[:1].upper()}{text[1:]}.")
        parts += [_effect(e) for e in EFFECTS.values() if e.role == role]
    return "\n\n".join(parts)


def _effect(effect: Effect) -> str:
    law = " \\\\\n".join(line.replace(" = ", " &= ", 1) for line in law_lines(effect))
    facts = [linear_line(effect)]
    if effect.absent:
        gone = ", ".join(f"`{n}` = {number(v)}" for n, v in effect.absent.items())
        facts.append(f"Absent at {gone}.")
    if effect.needs:
        facts.append(f"Needs {plain(', '.join(f'`{n}`' for n in sorted(effect.needs)))} beside it.")
    facts.append(f"Energy: {effect.energy}.")
    if effect.always:
        facts.append(f"Always: {', '.join(sorted(effect.always))}.")
    facts.append(f"Source: {plain(effect.source)}.")
    return "\n\n".join(
        [
            f"(effect-{effect.name})=\n### `{effect.name}`",
            f"**{plain(effect.title)}**",
            text_of(effect.text),
            "The law as the package reads it:",
            f"$$\n\\begin{{aligned}}\n{law}\n\\end{{aligned}}\n$$",
            parameter_table(effect.parameters),
            "\n".join(f"- {fact}" for fact in facts),
        ]
    )


def effect_table() -> str:
    rows = [
        [f"[`{e.name}`](#effect-{e.name})", e.role.replace("_", " "), plain(e.title)]
        for e in EFFECTS.values()
    ]
    return table(["effect", "role", "what it is"], rows)


def controllers() -> str:
    parts = []
    for law in CONTROLLERS.values():
        title = law.text.strip().split("\n")[0]
        linear = (
            "Has a linear form at frozen speed."
            if law.linear
            else "No linear form: transfer functions leave it out and say so."
        )
        parts += [
            f"(controller-{law.name})=\n### `{law.name}`",
            f"**{plain(title)}**",
            text_of(law.text),
            parameter_table(law.parameters),
            f"- {linear}\n- Source: {plain(law.source)}.",
        ]
    return "\n\n".join(parts)


def quantities() -> str:
    rows = []
    for name, (prismatic, revolute) in QUANTITIES.items():
        units = [", ".join(f"`{u}`" for u in kind.units) for kind in (prismatic, revolute)]
        rows.append([name.replace("_", " "), *units])
    return table(["quantity", "prismatic: SI unit, another", "revolute: SI unit, another"], rows)


def recordings() -> str:
    parts = []
    for name, recording in RECORDINGS.items():
        title = re.search(r'^title = "(.*)"', recording.experiment, re.M)
        notes = re.findall(r"^# (.*)", recording.experiment, re.M)
        where = sorted({(f.repository, f.commit) for f in recording.files})
        links = ", ".join(f"[{r}](https://github.com/{r}) at `{c[:10]}`" for r, c in where)
        parts += [
            f"### `{name}`",
            f"**{plain(title.group(1)) if title else name}**",
            plain(" ".join(notes)),
            f"Published files: {links}:",
            "\n".join(f"- `{f.path}`" for f in recording.files),
        ]
    return "\n\n".join(parts)


def constants(*modules: str) -> str:
    """Every public constant, and field with a default, of these modules with a comment above it."""
    rows = []
    for module in modules:
        full = f"teleopdesign.{module}"
        content, comments = import_module(full), ModuleAnalyzer.for_module(full).find_attr_docs()
        for (owner, name), text in comments.items():
            value = getattr(getattr(content, owner) if owner else content, name, None)
            if (owner or name.isupper()) and isinstance(value, int | float):
                words = plain(" ".join(text).strip(" ."))
                full_name = f"{owner}.{name}" if owner else name
                rows.append([f"`{module}.{full_name}`", number(value), words])
    return table(["constant", "value", "what it is, in the words of the code"], rows)


def api(module: str) -> str:
    """autodoc of the names in a module's `__all__`, from where they are defined."""
    full = "teleopdesign" if module == "." else f"teleopdesign.{module}"
    root, content = import_module("teleopdesign"), import_module(full)
    lines = []
    public = root.GROUPS | root.FURTHER
    names = [name for group in public.values() for name in group]
    top = {} if module == "." else {id(getattr(root, n)): n for n in names}
    groups = public if module == "." else {"": sorted(content.__all__, key=str.lower)}
    begins = {next(iter(names)): group for group, names in groups.items() if group}
    for name in (n for names in groups.values() for n in names):
        thing = getattr(content, name)
        if name in begins:
            lines += [f".. rubric:: {begins[name].capitalize()}", ""]
        if (short_name := top.get(id(thing))) is not None:
            lines += [
                f"``{full}.{name}``",
                f"   the same as :py:obj:`teleopdesign.{short_name}`",
                "",
            ]
        elif inspect.isclass(thing):
            lines += [f".. autoclass:: {full}::{name}", "   :members:", ""]
        elif callable(thing):
            lines += [f".. autofunction:: {full}::{name}", ""]
        else:
            lines += [
                f"``{full}.{name}``",
                f"   {'mapping' if isinstance(thing, Mapping) else type(thing).__name__}",
                "",
            ]
    return "\n".join(["```{eval-rst}", *lines, "```"])


_PRINTERS = {
    f.__name__: f
    for f in (effects, effect_table, controllers, quantities, recordings, constants, api)
}


def _value(match: re.Match[str]) -> str:
    path = match.group(1).split(".")
    # a field with a default is named by its class, whose name begins with a capital
    in_class = path[-2][:1].isupper()
    module = import_module(".".join(["teleopdesign", *path[: -2 if in_class else -1]]))
    return number(getattr(getattr(module, path[-2]) if in_class else module, path[-1]))


def _printed(match: re.Match[str]) -> str:
    what, *arguments = match.group(1).split()
    return _PRINTERS[what](*arguments)


def _source_read(app: Sphinx, name: str, source: list[str]) -> None:
    text = re.sub(r"<!-- print: (.*?) -->", _printed, source[0])
    source[0] = re.sub(r"@\{([\w.]+)\}", _value, text)


def _outdated(app: Sphinx, env: Any, *_: Any) -> list[str]:
    """Pages that print from the code are read anew in every build."""
    return [
        name
        for name in env.found_docs
        if re.search(r"<!-- print: |@\{", Path(env.doc2path(name)).read_text(encoding="utf-8"))
    ]


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("source-read", _source_read)
    app.connect("env-get-outdated", _outdated)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
