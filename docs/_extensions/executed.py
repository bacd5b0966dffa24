"""Examples that run while the pages are built, with what they really printed and drew.

    ```{session}          Python, statement by statement, in one namespace for each page
    ```{shell}            commands, run in the page's folder
    ```{shown} FILE       a file of `docs/examples`, which lies in the page's folder

Each page has a folder of its own, a copy of `docs/examples`. An example that fails, or that exits
with another status than `:status:` says, fails the build. Figures are put below the block that
makes them. An error that is to be shown: `:raises: ExperimentError`.
"""

from __future__ import annotations

import ast
import contextlib
import io
import os
import shutil
import subprocess
import sys
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

DOCS = Path(__file__).resolve().parents[1]
#: s after which an example counts as hung: a loaded machine takes minutes where it takes seconds
HANG = 3600
PAGES: dict[str, Page] = {}


class Page:
    """Folder and namespace in which the examples of one page run."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.figures = 0
        self.folder = Path(tempfile.mkdtemp(prefix="teleopdesign-docs-"))
        shutil.copytree(DOCS / "examples", self.folder, dirs_exist_ok=True)
        self.namespace: dict[str, Any] = {"__name__": "__main__"}

    def tidy(self, text: str) -> str:
        """Output without the folders of the machine that built the page."""
        package = Path(import_module("teleopdesign").__file__ or "").parents[1]
        for folder in (self.folder, self.folder.resolve(), package, DOCS.parent):
            text = text.replace(f"{folder}/", "").replace(str(folder), ".")
        return text


def page(name: str) -> Page:
    if name not in PAGES:
        PAGES[name] = Page(name)
    return PAGES[name]


def run_session(code: str, where: Page, raises: str | None) -> tuple[str, list[Any]]:
    """Transcript as at a prompt, and the figures that expressions gave."""
    transcript, figures, raised = "", [], None
    lines = code.splitlines()
    home = os.getcwd()
    os.chdir(where.folder)
    sys.path.insert(0, str(where.folder))
    try:
        for statement in ast.parse(code).body:
            source = lines[statement.lineno - 1 : statement.end_lineno]
            transcript += "".join(
                f"{'>>>' if i == 0 else '...'} {line}".rstrip() + "\n"
                for i, line in enumerate(source)
            )
            printed = io.StringIO()
            with contextlib.redirect_stdout(printed):
                try:
                    value = _value(statement, where.namespace)
                except Exception as error:
                    if raises is None or type(error).__name__ != raises:
                        raise
                    raised = raises
                    print(f"{type(error).__module__}.{raises}: {error}")
                    value = None
                if hasattr(value, "savefig"):
                    figures.append(value)
                elif value is not None:
                    print(repr(value))
            transcript += where.tidy(printed.getvalue())
    finally:
        os.chdir(home)
        sys.path.remove(str(where.folder))
    if raises is not None and raised is None:
        raise AssertionError(f"no {raises} was raised")
    return transcript, figures


def _value(statement: ast.stmt, namespace: dict[str, Any]) -> Any:
    if isinstance(statement, ast.Expr):
        return eval(compile(ast.Expression(statement.value), "<example>", "eval"), namespace)
    exec(compile(ast.Module([statement], []), "<example>", "exec"), namespace)
    return None


class Session(SphinxDirective):
    has_content = True
    option_spec = {
        "raises": directives.unchanged,
        "hidden": directives.flag,
        "alt": directives.unchanged,
        "width": directives.unchanged,
    }

    def run(self) -> list[nodes.Node]:
        here = page(self.env.docname)
        try:
            text, figures = run_session("\n".join(self.content), here, self.options.get("raises"))
        except Exception as error:
            raise self.error(f"example failed: {type(error).__name__}: {error}") from error
        content_nodes: list[nodes.Node] = []
        if "hidden" not in self.options:
            content_nodes.append(_literal(text, "pycon"))
        return content_nodes + [self.picture(figure, here) for figure in figures]

    def picture(self, figure: Any, here: Page) -> nodes.Node:
        import matplotlib.pyplot as plt

        here.figures += 1
        folder = DOCS / "_generated" / "figures"
        folder.mkdir(parents=True, exist_ok=True)
        name = f"{here.name.replace('/', '-')}-{here.figures}.png"
        figure.savefig(folder / name, dpi=200)
        plt.close(figure)
        image = nodes.image(
            uri=f"/_generated/figures/{name}",
            alt=self.options.get("alt", "figure of the example above"),
        )
        image["width"] = self.options.get("width", "100%")
        return image


class Shell(SphinxDirective):
    has_content = True
    option_spec = {"status": directives.nonnegative_int, "hidden": directives.flag}

    def run(self) -> list[nodes.Node]:
        here = page(self.env.docname)
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        environment = {**os.environ, "PATH": path, "COLUMNS": "96", "MPLBACKEND": "Agg"}
        text = ""
        for command in self.content:
            done = subprocess.run(
                command,
                shell=True,
                cwd=here.folder,
                env=environment,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=HANG,
            )
            if done.returncode != self.options.get("status", 0):
                raise self.error(f"status {done.returncode} of: {command}\n{done.stdout}")
            text += f"$ {command}\n{here.tidy(done.stdout)}"
        return [] if "hidden" in self.options else [_literal(text, "console")]


class Shown(SphinxDirective):
    required_arguments = 1
    option_spec = {"language": directives.unchanged}

    def run(self) -> list[nodes.Node]:
        file = DOCS / "examples" / self.arguments[0]
        self.env.note_dependency(str(file))
        block = _literal(file.read_text(encoding="utf-8"), self.options.get("language", "python"))
        return [block]


def _literal(text: str, language: str) -> nodes.literal_block:
    text = text.rstrip("\n")
    return nodes.literal_block(text, text, language=language, highlight_args={})


def _outdated(app: Sphinx, env: Any, *_: Any) -> list[str]:
    """Pages with examples are read anew in every build: what they show may have changed."""
    return [
        name
        for name in env.found_docs
        if any(
            mark in Path(env.doc2path(name)).read_text(encoding="utf-8")
            for mark in ("{session}", "{shell}", "{shown}")
        )
    ]


def _clean(app: Sphinx, *_: Any) -> None:
    """Where a page was read, in this process or another, its folder is no longer needed."""
    if done := PAGES.pop(app.env.docname, None):
        shutil.rmtree(done.folder, ignore_errors=True)


def setup(app: Sphinx) -> dict[str, Any]:
    import matplotlib

    matplotlib.use("Agg")
    app.add_directive("session", Session)
    app.add_directive("shell", Shell)
    app.add_directive("shown", Shown)
    app.connect("env-get-outdated", _outdated)
    app.connect("doctree-read", _clean)
    # each page has a folder, a namespace and names of figures of its own
    return {"parallel_read_safe": True, "parallel_write_safe": True}
