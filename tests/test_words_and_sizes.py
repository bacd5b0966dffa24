"""Names say what things are, one name means one thing, and functions stay readable."""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from syntax_trees import PACKAGE, syntax_trees

Function = ast.FunctionDef | ast.AsyncFunctionDef

#: participles and the like: they name grammar, where a name should say what it holds
BANNED = frozenset("asked found give given own referred said seen settled taken told tried".split())
#: such words say no more as a part of a name: `own_body`, `told_rows`
BANNED_PARTS = frozenset("found own said seen settled told tried".split())
#: a file without any of these words names nothing by one of them; `@given` is that of hypothesis
WORD = re.compile(rf"(?<![@a-z])(?:{'|'.join(BANNED | BANNED_PARTS)})(?![a-z])", re.I)
#: what else is written in Python, beside the package
ROOT = Path(__file__).parents[1]
FOLDERS = ("benchmarks", "docs", "golden", "release", "studies", "tests")
#: keywords of public functions, kept under the names that users type
PUBLIC_KEYWORDS = {
    # m or rad by which ideal friction gives before it slides: `simulate(..., give=...)`
    "give": (
        "blocks/environments",
        "frequency/measured_impedance",
        "frequency/measured_response",
        "frequency/sinusoid",
        "identify/largest_stiffness",
        "passivity/search/by_simulation",
        "realise/iosystem",
        "simulate",
        "studies/case",
        "studies/run",
        "tuning/simulation_fit",
    ),
    # motions that are prescribed: `bode(..., given=...)`, `transfer_function(..., given=...)`
    "given": ("derive", "frequency"),
}
#: compiled: their functions take arrays and places in them, for which there are no objects
COMPILED = ("realise/integrator",)
#: cells of a page: marimo gives each what it uses by name, nobody calls them
CELLS = ("app/notebook",)

#: lines of a file: beyond, a second concept is looked for. What is longer says why it is one
MOST_LINES_OF_A_FILE = 310
WHOLE = {
    "base/units": "symbols, quantities and their units are one table",
    "app/notebook": "cells of one page, which marimo reads from one file",
    "realise/integrator": "one loop, compiled as a whole",
    "realise/on_gpu": "all that runs on a GPU, and nothing else does",
}
MOST_LINES = 60
MOST_POSITIONAL = 6


def paths() -> dict[str, Path]:
    """Name such as "passivity/ports" -> file."""
    return {path.relative_to(PACKAGE).with_suffix("").as_posix(): path for path in syntax_trees()}


@cache
def modules() -> dict[str, ast.Module]:
    """Name such as "passivity/ports" -> syntax tree."""
    return {name: syntax_trees()[path] for name, path in paths().items()}


@cache
def functions() -> list[tuple[str, Function]]:
    return [
        (module, node)
        for module, tree in modules().items()
        for node in ast.walk(tree)
        if isinstance(node, Function)
    ]


def under(module: str, places: tuple[str, ...]) -> bool:
    return any(module == place or module.startswith(f"{place}/") for place in places)


def names(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Line and name of everything that a tree names: functions, parameters, locals, fields."""
    for node in ast.walk(tree):
        if isinstance(node, Function):
            yield node.lineno, node.name
        elif isinstance(node, ast.arg):
            yield node.lineno, node.arg
        elif isinstance(node, ast.ExceptHandler) and node.name is not None:
            yield node.lineno, node.name
        elif isinstance(node, ast.alias) and node.asname is not None:
            yield node.lineno, node.asname
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.id
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Store):
            yield node.lineno, node.attr


def misnamed(module: str, tree: ast.AST) -> list[str]:
    return [
        f"{module}:{line}: {name}"
        for line, name in names(tree)
        if BANNED_PARTS.intersection(name.lower().split("_"))
        or (name.strip("_") in BANNED and not under(module, PUBLIC_KEYWORDS.get(name, ())))
    ]


def positional(function: Function) -> int:
    arguments = [*function.args.posonlyargs, *function.args.args]
    return len([a for a in arguments if a.arg not in ("self", "cls")])


def length(function: Function) -> int:
    """Lines without those of the docstring, which holds an example where the function is public."""
    assert function.end_lineno is not None
    text = len((ast.get_docstring(function, clean=False) or "").splitlines())
    return function.end_lineno - function.lineno + 1 - text


def test_no_name_says_grammar_instead_of_a_thing():
    wrong = [one for module, tree in modules().items() for one in misnamed(module, tree)]
    assert not wrong, "\n".join(wrong)


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_name_beside_the_package_says_grammar_instead_of_a_thing(folder):
    """Studies, documentation, golden files, benchmarks, and tests with the names of the tests."""
    wrong = []
    for path in sorted((ROOT / folder).rglob("*.py")):
        text = path.read_text(encoding="utf-8")
        if WORD.search(text):
            module = path.relative_to(ROOT).with_suffix("").as_posix()
            wrong += misnamed(module, ast.parse(text))
    assert not wrong, "\n".join(wrong)


def type_of(node: ast.stmt, module: str) -> tuple[str, str] | None:
    """Name and meaning of a public type that a statement defines: a class, or a name for a type."""
    if isinstance(node, ast.ClassDef):
        name, meaning = node.name, module
    elif isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
        name, meaning = node.targets[0].id, ast.unparse(node.value)
    else:
        return None
    is_type = name[0].isupper() and not name.isupper() and not meaning.startswith("TypeVar")
    return (name, meaning) if is_type else None


def test_no_two_public_types_have_the_same_name():
    """Classes and names for types alike; one name for one type may be written in many modules."""
    meanings = defaultdict(set)
    for module, tree in modules().items():
        for node in tree.body:
            if defined := type_of(node, module):
                meanings[defined[0]].add(defined[1])
    assert {name: kinds for name, kinds in meanings.items() if len(kinds) > 1} == {}


def test_no_file_holds_a_second_concept():
    lengths = {m: len(p.read_text().splitlines()) for m, p in paths().items()}
    long = {m: n for m, n in lengths.items() if n > MOST_LINES_OF_A_FILE}
    assert long.keys() == WHOLE.keys(), long


def test_no_function_is_longer_than_a_page():
    long = [f"{m}.{f.name}: {length(f)}" for m, f in functions() if length(f) > MOST_LINES]
    assert not long, "\n".join(long)


def test_no_function_takes_more_positional_arguments_than_one_can_remember():
    wide = [
        f"{m}.{f.name}: {positional(f)}"
        for m, f in functions()
        if positional(f) > MOST_POSITIONAL and not under(m, (*COMPILED, *CELLS))
    ]
    assert not wide, "\n".join(wide)
