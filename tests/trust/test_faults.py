"""The planted faults of golden/ stay anchored: each right snippet is in the package, once."""

import importlib.util
import sys
from pathlib import Path

import pytest

PLACE = Path(__file__).parents[2] / "golden" / "faults.py"


@pytest.fixture(scope="module")
def planted():
    """The module that plants faults; it stands beside the package and its tests."""
    if not PLACE.exists():
        pytest.skip("no golden/ beside the tests")
    spec = importlib.util.spec_from_file_location("planted_faults", PLACE)
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look it up
    spec.loader.exec_module(module)
    return module


def test_each_planted_fault_has_one_place_and_leaves_a_file_that_compiles(planted):
    assert planted.unanchored(planted.read_faults()) == {}


def test_each_planted_fault_has_another_name_and_changes_something(planted):
    faults = planted.read_faults()
    assert len({f.name for f in faults}) == len(faults) >= 60
    assert all(f.old.split() != f.new.split() and f.kind and f.part for f in faults)


def test_the_table_tells_of_known_faults_and_of_tests_that_are_there(planted):
    table = planted.read_table()
    assert set(table) <= {f.name for f in planted.read_faults()}
    for one in filter(lambda one: one.suite in ("plain", "slow"), table.values()):
        file, _, test = one.by.partition("::")
        assert f"def {test.partition('[')[0]}(" in (planted.ROOT / file).read_text(), one.by


def test_a_snippet_is_looked_for_whatever_its_file_and_line_breaks(planted):
    fault = planted.Fault("", "", "", old="a = b + c", new="a = b - c")
    one, other = Path("one.py"), Path("other/two.py")
    texts = {one: "x = 1", other: "y = 2\na = b +\n    c\n"}
    assert planted.with_fault(fault, texts) == (other, "y = 2\na = b - c\n")
    for texts in ({one: "a = b"}, {one: "a = b + c", other: "a = b + c"}):
        with pytest.raises(LookupError):
            planted.with_fault(fault, texts)
