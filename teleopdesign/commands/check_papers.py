"""run the proof or check of every statement of the two papers"""

from __future__ import annotations

import argparse
import shutil
import textwrap
from collections import Counter
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

from ._options import add_output, write_requested
from ._terminal import replace_line

if TYPE_CHECKING:
    from ..papers import Result, Statement


EXAMPLES = """
  teleopdesign check-papers
  teleopdesign check-papers P12 P34
"""


def add(parser: argparse.ArgumentParser) -> None:
    """Arguments of the command."""
    parser.add_argument(
        "statement",
        nargs="*",
        help="P1 to P65: check only these statements, and print every step and number",
    )
    add_output(parser, "--json", "write the results")


def run(options: argparse.Namespace) -> int:
    """Print the table; returns 1 if an outcome differs from what the statement says."""
    from ..papers import STATEMENTS, check, find_statement

    chosen = [find_statement(name) for name in options.statement] or list(STATEMENTS.values())
    results = []
    for done, statement in enumerate(chosen):
        replace_line(f"{statement.name}: {done} of {len(chosen)} done")
        results.append(check(statement))
    replace_line("")
    width = max(72, min(shutil.get_terminal_size().columns, 120))
    print(
        "\n".join(_full(r, width) for r in results) if options.statement else _table(results, width)
    )
    counts = Counter(r.outcome for r in results).most_common()
    counted = ", ".join(f"{n} {outcome}" for outcome, n in counts)
    print(f"{len(results)} statements in {sum(r.seconds for r in results):.0f} s: {counted}.")
    write_requested(options, json=lambda: [result_data(r) for r in results])
    return 0 if all(r.as_stated for r in results) else 1


def _table(results: list[Result], width: int) -> str:
    """Lines for each statement: name, outcome, words, formula, source, place of the code."""
    first, second = 5, 20
    third = width - first - second - 2
    lines = [
        f"{'':<{first}}{'outcome':<{second}}statement; source; code that shows it",
        "-" * width,
    ]
    for r in results:
        s, cell = r.statement, [*textwrap.wrap(r.statement.words, third)]
        for word, text in (("", s.formula), ("printed: ", s.printed), ("given: ", s.assumes)):
            cell += textwrap.wrap(f"{word}{text}", third, subsequent_indent="  ") if text else []
        cell += textwrap.wrap(f"{s.paper.short}, {s.place}; {_code(s)}", third)
        columns = [s.name], textwrap.wrap(r.outcome, second - 1), cell
        rows = zip_longest(*columns, fillvalue="")
        lines += [f"{a:<{first}}{b:<{second}}{c}".rstrip() for a, b, c in rows]
        if r.outcome == "failed":
            why = [*r.details, *(str(f) for f in r.figures if not f.margin >= 0)]
            lines += [f"{'':<{first + second}}{line}" for line in why]
        lines.append("")
    return "\n".join(lines)


def _code(statement: Statement) -> str:
    if statement.code:
        return statement.code
    return f"no code, see {', '.join(f'P{n}' for n in statement.see)}"


def _full(result: Result, width: int) -> str:
    """All information on one statement, with every step and number."""
    s = result.statement
    code = f"teleopdesign.papers.{s.code}" if s.code else _code(s)
    parts = [(s.words, 4), (s.formula and f"    {s.formula}", 4), ("\n", 0)]
    parts += [
        (s.printed and f"printed: {s.printed}", 9),
        (s.assumes and f"given:   {s.assumes}", 9),
    ]
    parts += [(f"source:  {s.paper.full}; {s.place}", 9), (f"code:    {code}", 9)]
    parts += [(f"{i:>3}. {step}", 5) for i, step in enumerate(result.details, 1)]
    parts += [(f"   - {figure}", 5) for figure in result.figures]
    lines = [f"{s.name}  {result.outcome}", ""]
    for text, indent in parts:
        if text:
            lines += textwrap.wrap(text, width, subsequent_indent=" " * indent) or [""]
    return "\n".join([*lines, ""])


def result_data(result: Result) -> dict[str, Any]:
    """A result as plain data; each figure has the range in which it must lie and its margin."""
    s = result.statement

    return {
        "statement": s.name,
        "outcome": result.outcome,
        "as_stated": result.as_stated,
        **{n: getattr(s, n) for n in ("words", "formula", "printed", "assumes", "place")},
        "paper": s.paper.full,
        "code": s.code and f"teleopdesign.papers.{s.code}",
        "see": [f"P{n}" for n in s.see],
        "found": list(result.details),
        "figures": [
            {
                "what": f.what.strip(),
                "found": f.value,
                "low": f.low,
                "high": f.high,
                "unit": f.unit,
                "margin": f.margin,
            }
            for f in result.figures
        ],
        "seconds": round(result.seconds, 3),
    }
