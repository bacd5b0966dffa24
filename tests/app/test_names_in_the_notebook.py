"""The page's notebook: its cells get modules as arguments, which no type checker sees."""

import ast
import inspect
from pathlib import Path

import pytest

import teleopdesign.app
from teleopdesign.app import blocks, export, files, logs, pages, server
from teleopdesign.app.task import BackgroundTask
from teleopdesign.app.workbench import Workbench

SOURCE = Path(teleopdesign.app.__file__).with_name("notebook.py")
#: what a cell calls by these names
OWNERS = {
    "blocks": blocks,
    "export": export,
    "files": files,
    "logs": logs,
    "pages": pages,
    "server": server,
    "bench": Workbench,
    "BackgroundTask": BackgroundTask,
    "task": BackgroundTask,
}


def attributes(text):
    """(owner, attribute) of each attribute that is read of a name."""
    return {
        (node.value.id, node.attr)
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name)
    }


def has(owner, name):
    # attributes of an instance that `__init__` sets, and fields of a dataclass, are in its source
    return (
        hasattr(owner, name)
        or name in getattr(owner, "__annotations__", ())
        or (isinstance(owner, type) and f"self.{name}" in inspect.getsource(owner))
    )


def test_what_a_cell_calls_exists():
    pytest.importorskip("marimo", reason="needs the extra app")
    from teleopdesign.app import views

    owners = OWNERS | {"views": views}
    read = attributes(SOURCE.read_text())
    assert {o for o, _ in read} >= set(owners) - {"BackgroundTask"}
    assert [f"{o}.{a}" for o, a in sorted(read) if o in owners and not has(owners[o], a)] == []
