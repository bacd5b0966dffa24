"""`import teleopdesign` is instant, and every name that it promises is there and documented."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

from syntax_trees import syntax_trees

import teleopdesign as td

HEAVY = ("numpy", "scipy", "sympy", "numba", "control", "matplotlib", "xarray", "pooch")
ROOT = Path(td.__file__).parent


def modules_after(code):
    """Heavy modules that a fresh interpreter holds after running this."""
    code += f"\nimport sys; print(*[m for m in {HEAVY} if m in sys.modules])"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(run.stdout.split())


def test_the_import_alone_loads_nothing_heavy():
    assert modules_after("import teleopdesign") == set()


def test_reading_an_experiment_needs_neither_kernels_nor_figures():
    loaded = modules_after("import teleopdesign; teleopdesign.load_experiment")
    assert loaded.isdisjoint({"numba", "control", "matplotlib", "xarray"})


def test_a_diagnosis_imports_at_its_start_only_what_each_diagnosis_needs_there():
    """Filters and trees come where they are used: an error of the experiment costs no import."""
    later = ("scipy.signal", "scipy.stats", "sklearn", "pandas", "pooch", "control", "matplotlib")
    code = "import sys, teleopdesign.commands.diagnose, teleopdesign.diagnose.answer\n"
    loaded = modules_after(code + f"print(*[m for m in {later} if m in sys.modules])")
    assert loaded.isdisjoint({*later, "xarray"})


def test_a_worker_of_a_study_loads_only_what_a_simulation_needs():
    others = [f"teleopdesign.{f}" for f in ("diagnose", "passivity", "tuning", "show")]
    code = "import sys, teleopdesign.studies.processes\n"
    code += f"print(*[m for m in {others} if m in sys.modules])"
    loaded = modules_after(code)
    assert loaded.isdisjoint({*others, "numba", "control", "matplotlib", "xarray"})


def test_every_public_name_resolves_and_is_documented():
    for name in td.__all__:
        value = getattr(td, name)
        if inspect.isclass(value) or inspect.isfunction(value):
            assert inspect.getdoc(value), f"{name} has no docstring"
            assert value.__module__.startswith("teleopdesign"), name
        assert name in dir(td)


def test_the_names_are_those_that_type_checkers_see():
    """The lazy names and the imports for type checkers are the same."""
    tree = ast.parse(Path(td.__file__).read_text())
    (block,) = [n for n in tree.body if isinstance(n, ast.If)]
    imported_names = [a.asname or a.name for f in block.body for a in f.names if f.module]
    further = [name for names in td.FURTHER.values() for name in names]
    assert sorted(imported_names) == sorted([*td.__all__, *further])


def test_the_map_of_folders_is_that_of_the_package():
    """Every folder or module named in the package's docstring exists."""
    block = td.__doc__.split("The folders")[1]
    named = [line.split()[0] for line in block.splitlines() if line.startswith("    ")]
    assert len(named) > 8
    for name in named:
        assert (ROOT / name).is_dir() or (ROOT / f"{name}.py").is_file(), name


def test_every_module_and_public_function_has_a_docstring():
    bare = {str(source.relative_to(ROOT)): without_docstring(source) for source in syntax_trees()}
    assert {source: names for source, names in bare.items() if names} == {}


def without_docstring(source):
    """What should have a docstring and has none: names of functions, or the module's own."""
    tree = syntax_trees()[source]
    if not ast.get_docstring(tree):
        return [source.name]
    if source.parent.name in ("effects", "of_blocks", "controllers") and source.name[0] != "_":
        return []  # the law's meaning is the file's docstring
    return [
        node.name
        for node in tree.body
        if isinstance(node, ast.FunctionDef | ast.ClassDef)
        and not node.name.startswith("_")
        and not ast.get_docstring(node)
        and len(node.body) > 1  # one line says itself
    ]


def test_tests_mirror_the_package():
    """Each folder with code has a folder of tests with its name; `examples` holds data."""
    folders = {p.parent.name for p in ROOT.glob("*/__init__.py")} - {"examples"}
    here = Path(__file__).parent
    tested = {p.relative_to(here).parts[0] for p in here.glob("*/**/test_*.py")}
    assert len(folders) > 20 and folders <= tested
