"""Every public function says how it is called, and its example prints what it says."""

import doctest
import inspect

import numpy as np
import pytest

import teleopdesign as td

#: classes that functions of other names return, and errors
WITHOUT = {"Body", "Diagram", "Experiment", "ExperimentError", "ModelError"}
USUAL = [name for names in td.GROUPS.values() for name in names if callable(getattr(td, name))]
FURTHER = [name for names in td.FURTHER.values() for name in names if callable(getattr(td, name))]


def examples_of(name):
    text = inspect.getdoc(getattr(td, name)) or ""
    return doctest.DocTestParser().get_doctest(text, {"td": td, "np": np}, name, None, None)


def test_every_public_function_has_an_example():
    assert [n for n in USUAL if not examples_of(n).examples and n not in WITHOUT] == []


@pytest.mark.slow
@pytest.mark.parametrize("name", [*USUAL, *FURTHER])
def test_an_example_prints_what_it_says(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    printed = []
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE, verbose=False)
    assert runner.run(examples_of(name), out=printed.append).failed == 0, "".join(printed)
