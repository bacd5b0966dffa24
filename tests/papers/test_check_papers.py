"""Statements of the two papers have the stated outcome, and only a proof makes one "proved"."""

import ast
import importlib
import inspect
import json

import pytest
import sympy as sp

from teleopdesign.cli import main
from teleopdesign.papers import (
    HOW,
    STATEMENTS,
    Correction,
    Figure,
    NotProved,
    Numbers,
    check,
)
from teleopdesign.papers._proof import (
    BlocksDiffer,
    Equal,
    Grows,
    Holds,
    Limit,
    NotNegative,
    proof,
)
from teleopdesign.papers._statement import DERIVED, claim, shows

#: over a quarter of a second each, together a quarter of a minute
NUMBERS = (15, 17, 18, 21, 22, 23, 31, 32, 33, 34, 38, 40, 43, 44, 45, 46, 47, 49, 50, 51, 54, 55)
SLOW = {f"P{n}" for n in (*NUMBERS, 56, 60, 61, 62, 63, 64)}
SHOWN = [n for n, s in STATEMENTS.items() if s.shown_by is not None]
x, y = sp.symbols("x y", positive=True)
h = sp.Symbol("h", nonnegative=True)


def outcome_is_as_stated(name):
    result = check(STATEMENTS[name])
    assert result.as_stated, (result.outcome, result.details, [str(f) for f in result.figures])
    return result


@pytest.mark.parametrize("name", [n for n in STATEMENTS if n not in SLOW])
def test_a_statement_is_known_as_far_as_it_says(name):
    outcome_is_as_stated(name)


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(SLOW))
def test_a_statement_that_takes_longer_is_known_as_far_as_it_says(name):
    # ten seconds for a symbolic result on a core of its own; twice that where cores are shared
    assert outcome_is_as_stated(name).seconds < 20


def test_no_statement_is_missing():
    assert list(STATEMENTS) == [f"P{n}" for n in range(1, 66)]


@pytest.mark.parametrize("name", STATEMENTS)
def test_a_statement_stands_alone(name):
    """Words, paper, place and outcome; a formula and code unless it is a claim."""
    s = STATEMENTS[name]
    assert s.how in HOW
    assert len(s.words) > 30 and s.words.endswith(".") and s.paper.full and s.place
    if s.shown_by is None:
        assert s.how == "claim of the paper" and not s.code
        assert all(f"P{n}" in STATEMENTS for n in s.see) and s.see
    else:
        assert s.formula and s.code
    if s.how == "refuted":
        assert s.printed


# nothing but proofs proves


@pytest.mark.parametrize("name", SHOWN)
def test_the_outcome_follows_from_the_kind_of_evidence(name):
    expected = {"proved": "ProofSteps", "refuted": "Correction", "checked numerically": "Numbers"}
    function = STATEMENTS[name].shown_by
    assert inspect.get_annotations(function)["return"] == expected[STATEMENTS[name].how]


FORBIDDEN = {*"np numpy math float simulate brentq evalf N Float nsimplify".split()}


def parts(function):
    """The function and those of its module that it calls, directly or not, as syntax trees."""
    module = importlib.import_module(function.__module__)
    tree = ast.parse(inspect.getsource(module))
    known = {n.name: n for n in tree.body if isinstance(n, ast.FunctionDef)}
    todo, functions = [function.__name__], {}
    while todo:
        name = todo.pop()
        if name not in functions:
            functions[name] = ast.Module(known[name].body, [])  # without its decorator's numbers
            todo += [n.id for n in ast.walk(functions[name]) if getattr(n, "id", None) in known]
    return functions.values()


@pytest.mark.parametrize("name", [n for n in SHOWN if STATEMENTS[n].how in ("proved", "refuted")])
def test_a_proof_touches_no_float(name):
    nodes = [n for part in parts(STATEMENTS[name].shown_by) for n in ast.walk(part)]
    floats = [n.value for n in nodes if isinstance(n, ast.Constant) and isinstance(n.value, float)]
    used = {getattr(n, "id", getattr(n, "attr", "")) for n in nodes}
    assert not floats and not used & FORBIDDEN


@pytest.mark.parametrize(
    "step",
    [
        Equal("a float", sp.Float(0.5), sp.Rational(1, 2)),
        NotNegative("a float", sp.Float(0.5) * x, sp.Float(0.5) * x),
        Limit("a float", sp.Float(0.5) * x, x, sp.S(0), sp.S(0)),
        Holds("a float", sp.Float(1.5), ">", sp.S(1)),
        Grows("a float", sp.Float(0.5) * x, x, sp.Float(0.5)),
    ],
    ids=lambda s: type(s).__name__,
)
def test_a_step_with_a_float_is_refused(step):
    with pytest.raises(NotProved, match="float"):
        proof(step).verify()


A, B = sp.symbols("A B", commutative=False)
FALSE = {
    "an identity": Equal("w", (x + y) ** 2, x**2 + y**2),
    "an identity that holds at a point": Equal("w", x**2, 3 * x - 2),
    "a sign": NotNegative("w", x - y, x - y),
    "a form that is another expression": NotNegative("w", x - y, x + y),
    "a hypothesis that nobody made": NotNegative("w", x - y, h, {h: x - y}),
    "a hypothesis under a symbol of any sign": NotNegative(
        "w", x - y, sp.Symbol("r", real=True) ** 2, {sp.Symbol("r", real=True): x - y}
    ),
    "strictness": NotNegative("w", h, h, strictly=True),
    "growth from below zero": Grows("w", x - 1, x, sp.S(1)),
    "growth with a falling part": Grows("w", x - x**2, x, sp.S(1)),
    "a limit": Limit("w", sp.sin(x) / x, x, sp.S(0), sp.S(0)),
    "a relation": Holds("w", sp.sqrt(2), ">", sp.Rational(3, 2)),
    "a relation of symbols": Holds("w", x + y, ">", x),
    "commuting blocks": Equal("w", A * B, B * A),
    "blocks that are equal": BlocksDiffer("w", A * (A + B) ** -1, 1 - B * (A + B) ** -1),
}


@pytest.mark.parametrize("what", FALSE)
def test_a_false_step_is_not_proved(what):
    with pytest.raises(NotProved, match="w"):
        proof(FALSE[what]).verify()


def test_a_step_may_use_what_is_assumed_and_what_was_shown():
    used = NotNegative("w", 2 * x - 2 * y, 2 * h, {h: x - y})
    assert proof(used, assuming=[x - y]).verify() == ("w",)
    less = Grows("u", x - sp.tanh(x), x, sp.tanh(x) ** 2)
    later = NotNegative("w", x**2 - x * sp.tanh(x), x * h, {h: x - sp.tanh(x)})
    assert proof(less, later).verify() == ("u", "w")
    with pytest.raises(NotProved, match="neither assumed nor shown"):
        proof(later, less).verify()


def test_no_steps_prove_nothing():
    with pytest.raises(NotProved):
        proof().verify()


def stated(evidence, how="proved", numbers=None):
    """A statement made for a test."""

    @shows(1, DERIVED, "here", how=how, numbers=numbers)
    def shown():
        """Words.

        formula: f
        """
        return evidence

    return shown


TRUE = proof(Equal("w", x + x, 2 * x))
WRONG = proof(Equal("w", x, y))


def test_numbers_never_prove_a_statement():
    result = check(stated(Numbers((Figure("one", 1.0, 0.9, 1.1),))))
    assert result.outcome == "checked numerically" and not result.as_stated


def test_a_refutation_needs_both_the_failure_and_the_corrected_form():
    assert check(stated(Correction(TRUE, TRUE), "refuted")).as_stated
    assert check(stated(Correction(WRONG, TRUE), "refuted")).outcome == "failed"
    assert check(stated(Correction(TRUE, WRONG), "refuted")).outcome == "failed"


@pytest.mark.parametrize("number", [1.2, 0.8, float("nan")])
def test_a_number_out_of_its_range_fails_a_proof_beside_it(number):
    def numbers():
        return Numbers((Figure("one", number, 0.9, 1.1),))

    assert check(stated(TRUE, numbers=numbers)).outcome == "failed"
    assert check(stated(numbers(), "checked numerically")).outcome == "failed"


def test_a_claim_stays_a_claim():
    made = claim(1, DERIVED, "here", "Words.", ())
    assert check(made).outcome == "claim of the paper"


# the command


def test_the_command_shows_every_step_of_the_chosen_statements(capsys, tmp_path):
    file = tmp_path / "papers.json"
    assert main(["check-papers", "P16", "P24", "P29", "--json", str(file)]) == 0
    out = capsys.readouterr().out
    assert "P16  refuted" in out and "printed: 4 j F_C/A: pi is missing" in out
    assert "1. against the print: the first harmonic of sgn is 4/pi, not 4" in out
    assert "code:    no code, see P13, P38, P47, P48" in out
    assert "3 statements" in out and "2 refuted, 1 claim of the paper" in out
    answer = json.loads(file.read_text())
    assert [r["statement"] for r in answer] == ["P16", "P24", "P29"]
    assert answer[0]["code"] == "teleopdesign.papers.describing_functions.coulomb_friction"
    assert all(r["as_stated"] for r in answer)


def test_a_failing_statement_is_reported_and_gives_status_1(capsys, monkeypatch):
    from teleopdesign import papers

    monkeypatch.setattr(papers, "STATEMENTS", {"P1": stated(WRONG)})
    assert main(["check-papers"]) == 1
    assert "failed" in (out := capsys.readouterr().out) and "w: no proof that x = y" in out


def test_an_unknown_statement_is_one_line(capsys):
    assert main(["check-papers", "P66"]) == 2
    assert 'no statement "P66", expected P1 to P65; did you mean' in capsys.readouterr().err
    assert main(["check-papers", "P1", "--json", "papers.csv"]) == 2
    assert ".json" in capsys.readouterr().err
