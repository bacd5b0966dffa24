"""What each theorem proves is stated by the checker, with the values it was proved for."""

import random
from fractions import Fraction

import pytest
from passivity.small_certificates import sealed
from passivity.test_hypotheses import FUNCTIONS, NAMES, inside

from teleopdesign.passivity.checker import check

#: no theorem of them proves what is passive: they refute, or search
NEVER_PROVED = {"free_motion"}
#: argument -> factor, without which what is drawn lies beyond the limit of the theorem
SMALL = {
    "delayed_spring": {"stiffness": 0.01},
    "velocity_compensation": {"compensator_level": 1e-5},
    "cancelled_inertia": {"cancelled": 1e-6},
}


def proved_claims(function, number=3, tries=60):
    rng, theorem_claims = random.Random(7), []
    for _ in range(tries):
        arguments = inside(function, rng)
        if function.__name__ == "sampled_compensation":
            arguments["presliding_stiffness"] = None
        for name, share in SMALL.get(function.__name__, {}).items():
            arguments[name] *= share
        claim = function(**arguments)
        if claim.status == "proved":
            theorem_claims.append((arguments, claim))
        if len(theorem_claims) == number:
            break
    return theorem_claims


@pytest.mark.parametrize("function", FUNCTIONS, ids=NAMES)
def test_the_statement_of_every_theorem_holds_its_values_and_no_words_of_a_file(function):
    if function.__name__ in NEVER_PROVED:
        pytest.skip("a search: nothing is proved")
    claims = proved_claims(function)
    assert claims, f"{function.__name__} proved nothing of what was drawn"
    for arguments, claim in claims:
        assert claim.certificates
        statements = [check(dict(c.content)) for c in claim.certificates]
        for certificate, statement in zip(claim.certificates, statements, strict=True):
            for name, value in certificate.content.get("example", {}).items():
                assert f"{name} = {value}" in statement
            edited = {**certificate.content, "title": "everything is passive within 500 N"}
            assert check(sealed(edited)) == statement and "500 N" not in statement
        # another value is another statement: it comes from the content and not from the function
        changed = [a for n, a in arguments.items() if isinstance(a, float) and n != "rng"]
        whole_text = " ".join(statements)
        exact = {str(Fraction(repr(a))) for a in changed} | {str(a) for a in changed}
        assert any(text in whole_text for text in exact) or "positive real" in whole_text
