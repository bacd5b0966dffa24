"""The names that a user types: one word each for both halves of the package, and their folders."""

import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import teleopdesign as td
from teleopdesign.base.arguments import type_imports
from teleopdesign.base.folders import INSTEAD, VERBS

ROOT = Path(td.__file__).parent
TOP = {p.stem for p in ROOT.glob("*.py")} | {p.parent.name for p in ROOT.glob("*/__init__.py")}


def test_no_public_name_is_that_of_a_folder():
    """Python gives `td.NAME` to the folder once it is imported: a function there would be lost."""
    assert not set(td.__all__) & TOP


@pytest.mark.parametrize(("folder", "function"), VERBS.items())
def test_a_folder_named_by_a_verb_runs_the_function_that_is_meant(folder, function):
    with pytest.raises(td.TeleopDesignError, match=getattr(td, function).__name__) as problem:
        getattr(td, folder)(3.7)
    with pytest.raises(td.TeleopDesignError) as same:
        getattr(td, function)(3.7)
    assert str(problem.value) == str(same.value)


@pytest.mark.parametrize("folder", sorted({n for n in dir(td) if n in TOP} - set(VERBS)))
def test_a_folder_that_is_no_verb_says_what_to_type(folder):
    with pytest.raises(TypeError, match=rf"td\.{folder} is a folder.*; .*(td\.\w|write|type|plot)"):
        getattr(td, folder)(1)


def test_every_folder_with_functions_has_a_rule_for_a_call():
    """A new folder named by a verb must run something: nobody knows `find_missing` by heart."""
    assert set(VERBS.values()) <= set(td.__all__)
    assert {*VERBS, *INSTEAD} <= set(dir(td))


def test_every_public_name_has_one_group_and_the_docstring_shows_the_groups():
    grouped = [n for group in td.GROUPS.values() for n in group]
    assert sorted(grouped) == sorted(td.__all__)
    shown = td.__doc__.split("The names that a user types:\n\n")[1].split("\n\n")[0]
    words = shown.replace(",", " ").split()
    assert words == [w for group, names in td.GROUPS.items() for w in (group, *names)]


@pytest.mark.slow
def test_a_folder_is_there_without_a_separate_import():
    """In a package that nothing has used before: one process that forgets it in between.

    One way leads to all of them: every eighth is enough.
    """
    folders = sorted(n for n in dir(td) if n in TOP)[::8]
    code = (
        "import sys\n"
        f"for folder in {folders}:\n"
        "    for name in [n for n in sys.modules if n.partition('.')[0] == 'teleopdesign']:\n"
        "        del sys.modules[name]\n"
        "    import teleopdesign as td\n"
        "    print(getattr(td, folder).__name__)\n"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert run.stdout.split() == [f"teleopdesign.{folder}" for folder in folders]


def test_few_names_are_shown_and_every_other_public_name_stays_within_reach():
    further = [name for names in td.FURTHER.values() for name in names]
    assert len(td.__all__) <= 40 and not set(further) & set(td.__all__)
    for name in further:
        home, local = type_imports("teleopdesign")[name]
        assert getattr(td, name) is getattr(import_module(home), local)


def test_a_misspelt_name_is_answered_with_the_nearest():
    with pytest.raises(AttributeError, match='did you mean "haptic_interface"'):
        td.haptic_interfac  # noqa: B018


def test_numbers_stand_wherever_values_do():
    body = td.Body("prismatic", {"inertia": 0.15})
    assert body == td.Body("prismatic", {"inertia": td.Value(0.15)})
    assert body.with_values({"inertia": 0.2}).parameters["inertia"] == td.Value(0.2)
    model = td.Model({"device": body}).with_effect("viscous", values={"damping": 2})
    assert model.parameters["device.viscous.damping"] == td.Value(2.0)
    diagram = td.haptic_interface(body).with_values({"Z_M.inertia": 1})
    assert diagram.values["Z_M.inertia"] == 1.0


def test_a_law_may_be_there_twice_under_numbered_names():
    low = td.controller("low_pass", {"bandwidth": 20.0})
    twice = low.then(low)
    assert twice.names() == {"low_pass.bandwidth": 20.0, "low_pass_2.bandwidth": 20.0}
    changed = twice.with_values({"low_pass_2.bandwidth": 30.0})
    assert changed.names() == {"low_pass.bandwidth": 20.0, "low_pass_2.bandwidth": 30.0}
    thrice = changed.then(low)
    assert list(thrice.names()) == [f"low_pass{n}.bandwidth" for n in ("", "_2", "_3")]
