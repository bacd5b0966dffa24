"""What the checker must say of small certificates whose truth is known by hand."""

import json
from fractions import Fraction
from itertools import product

import pytest
from passivity.small_certificates import sealed, storage

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
