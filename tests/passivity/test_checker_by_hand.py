"""What the checker must say of small certificates whose truth is known by hand."""

import json
import re
import sys
from fractions import Fraction
from itertools import product
from pathlib import Path

import pytest
from passivity.small_certificates import sealed, storage

import teleopdesign as td
from teleopdesign.passivity.checker import Refused, check, main


def is_proved(content):
    try:
        return bool(check(content))
    except Refused:
        return False


def two_port(kind, entries):
    rows = [[entries[0], entries[1]], [entries[2], entries[3]]]
    return sealed({"kind": kind, "title": "", "impedance": rows})


SIZES = [Fraction(0), Fraction(1), Fraction(3, 2), Fraction(2), Fraction(-1), Fraction(-3, 2)]


@pytest.mark.parametrize("element", ["{}/s", "{}*s", "({})"])
@pytest.mark.parametrize("matrix", [(1, 1), (1, 2), (2, Fraction(9, 8)), (0, 2)])
def test_springs_masses_and_dampers_across_two_ports_are_stable_as_their_matrix_says(
    element, matrix
):
    """Where both ports act on each other alike: as far as the matrix gives out no energy.

    Where they act oppositely, as in a gyrator, dampers never give out any, and springs and masses
    always do. Where one does not act on the other, nothing can grow.
    """
    for across in SIZES:
        ways = {
            (across, across): matrix[0] * matrix[1] >= across**2,
            (across, -across): across == 0 or element == "({})",
            (across, 0): True,
        }
        for (forth, back), holds in ways.items():
            entries = [element.format(x) for x in (matrix[0], forth, back, matrix[1])]
            assert is_proved(two_port("absolute stability", entries)) == holds, entries


TANK = "s/(s**2 + 2)"
#: z11, z12, z21, z22, and whether the two-port is absolutely stable
TWO_PORTS = [
    (("1", "1", "1", "1"), True),  # the limit itself
    (("1 + 1/s", "1/s", "1/s", "1 + 1/s"), True),
    ((f"1 + {TANK}", TANK, TANK, f"1 + {TANK}"), True),
    (("s + 1", "3", "-3", "s + 1"), True),
    (("0", "0", "0", "0"), True),
    (("(9*s**2/4 + s + 1)/(9*s + 1)", "s/4", "s/4", "(9*s**2/4 + s + 1)/(9*s + 1)"), True),
    (("(9*s**2/4 + s + 1)/(9*s + 1)", "3*s/10", "3*s/10", "(9*s**2/4 + s + 1)/(9*s + 1)"), False),
    (("s + 1 + 1/s", "2/s", "2/s", "s + 1 + 1/s"), False),  # residues that the axis does not show
    (("s + 1", "s", "s", "1 + s/2"), False),
    (("0", TANK, TANK, "1"), False),
    ((TANK, TANK, TANK, f"999999/1000000*{TANK}"), False),
    (("1", "1", "1001/1000", "1"), False),
    (("1", "0", "0", "-1"), False),
    (("1", "1/(s - 1)", "0", "1"), False),
    (("1", "0", "1/(s**2 - s + 1)", "1"), False),
    (("1", "0", "1/s**2", "1"), False),
    (("1", "s**2", "0", "1"), False),
    (("1", "1/(s**2 + 1)**2", "0", "1"), False),
    (("1", "(s - 1)/(s - 1)/s", "1/s", "1"), False),
]


@pytest.mark.parametrize(("entries", "holds"), TWO_PORTS, ids=range(len(TWO_PORTS)))
def test_a_two_port_is_accepted_only_where_no_termination_makes_it_grow(entries, holds):
    assert is_proved(two_port("absolute stability", entries)) == holds


def test_a_term_of_weight_zero_changes_no_proof_and_one_below_zero_is_none():
    def weighed(weight):
        term = [["1", {"b": 1}, "v"], [weight, {}, "v"]]
        proofs = storage()["proofs"] | {"supply": {"1": term, "-1": term}}
        return storage(proofs=proofs, supply=f"p*v + b*v**2 + ({weight})*v**2")

    assert is_proved(weighed("0")) and is_proved(weighed("1/2"))
    assert not is_proved(weighed("-1/2"))


def test_the_command_says_by_its_status_whether_all_files_prove_something(tmp_path, capsys):
    good, bad = tmp_path / "good.json", tmp_path / "bad.json"
    good.write_text(json.dumps(storage()))
    bad.write_text(json.dumps(storage(supply="p*v - b*v**2")))
    for files in product([good, bad], repeat=2):
        assert main([str(f) for f in files]) == int(bad in files)
        lines = capsys.readouterr().out.splitlines()
        assert ["proved" in line for line in lines] == [f is good for f in files]
    assert main([str(good)]) == 0 and main([str(tmp_path / "none.json")]) == 1
    assert main([]) == 2


CHECKER = Path(td.__file__).parent / "passivity" / "checker"
#: they write certificates, and check those of a file
READERS = {"claims/certificate.py", "commands/passivity.py"}
IMPORTS = re.compile(r"^ *from ([\w.]+) import (?:\([^)]*\)|.*)|^ *import .*", re.M)


def test_the_checker_imports_itself_and_the_standard_library_alone():
    """A checker that shared code with the prover would accept the prover's mistakes."""
    modules = re.compile(r"^ *(?:from|import) ([\w.]+)", re.M)
    for path in CHECKER.glob("*.py"):
        for name in modules.findall(path.read_text()):
            is_beside = name.startswith(".") and not name.startswith("..")
            assert is_beside or name.partition(".")[0] in sys.stdlib_module_names, (path, name)


def test_no_prover_imports_the_checker():
    users = {
        "/".join(path.parts[-2:])
        for path in Path(td.__file__).parent.rglob("*.py")
        if path.parent != CHECKER
        and any(re.search(r"\bchecker\b", m[0]) for m in IMPORTS.finditer(path.read_text()))
    }
    assert users == READERS
