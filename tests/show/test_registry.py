"""Every result that asks for its looks has them, and none words or draws itself."""

from __future__ import annotations

import ast
import inspect
import pkgutil
from importlib import import_module

import pytest
from example_objects import QUICK
from syntax_trees import PACKAGE, syntax_trees

from teleopdesign import Study
from teleopdesign.base.shown import Shown, figure_of
from teleopdesign.show.registry import look_of, shows

#: folders of results: what they print and draw stands in `show`
FOLDERS = (
    "design",
    "frequency",
    "identify",
    "next_experiment",
    "passivity",
    "simulate",
    "studies",
    "tuning",
    "unexplained",
)


def classes():
    """Every class of the package's results, with the looks of all of them loaded."""
    for folder in FOLDERS:
        package = import_module(f"{PACKAGE.name}.{folder}")
        for part in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if part.name.endswith("__main__"):
                continue
            module = import_module(part.name)
            for kind in vars(module).values():
                if inspect.isclass(kind) and kind.__module__ == module.__name__:
                    yield kind


@pytest.mark.parametrize("kind", sorted(classes(), key=lambda k: k.__qualname__))
def test_a_result_has_the_looks_that_it_asks_for(kind):
    if kind.__name__.startswith("Abstract"):
        return
    if issubclass(kind, Shown):
        assert look_of("text", kind) or look_of("table", kind)
    if hasattr(kind, "plot") and not isinstance(inspect.getattr_static(kind, "plot"), property):
        assert look_of("figure", kind)


@pytest.mark.parametrize("folder", FOLDERS)
def test_no_result_words_itself(folder):
    """A text in a class of its folder would be a second place to look for texts."""
    written = [
        f"{path.stem}.{node.name}"
        for path, tree in syntax_trees().items()
        if path.relative_to(PACKAGE).parts[0] == folder
        for node in tree.body
        if isinstance(node, ast.ClassDef)
        and not node.name.startswith("_")
        and any(getattr(m, "name", "") in ("__repr__", "_repr_html_") for m in node.body)
    ]
    assert written == []


def test_two_functions_for_one_look_are_refused():
    assert look_of("text", Study)
    with pytest.raises(ValueError, match="two functions give the text of Study"):

        @shows("text")
        def again(study: Study) -> str:
            return ""


def test_a_result_without_a_figure_says_so():
    with pytest.raises(TypeError, match="show: no figure of Samples"):
        figure_of(QUICK["samples"]())
