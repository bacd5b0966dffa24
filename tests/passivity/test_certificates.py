"""Certificates: a small program verifies them without the package, and refuses the rest."""

import copy
import hashlib
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import sympy as sp

from teleopdesign.base.errors import ModelError
from teleopdesign.passivity import (
    Certificate,
    checker,
    dahl_compensation,
    positive_real,
    read_certificate,
    read_record,
    write_record,
)

FOLDER = Path(checker.__file__).parent


def resealed(content):
    """As a forger would: with a digest that fits."""
    body = {k: v for k, v in content.items() if k != "digest"}
    text = json.dumps(body, sort_keys=True)
    return Certificate({**body, "digest": hashlib.sha256(text.encode()).hexdigest()})


def test_the_checker_is_short_enough_to_be_read_whole():
    """1900 lines in files of at most 300, each a concept with its proof."""
    lengths = [len(file.read_text().splitlines()) for file in FOLDER.glob("*.py")]
    assert sum(lengths) <= 1900 and max(lengths) <= 300


def test_every_proof_has_certificates_that_the_checker_accepts(certificates):
    assert len(certificates) >= 13
    for name, certificate in certificates.items():
        assert certificate.check(), name


@pytest.mark.slow
def test_the_checker_runs_alone(certificates, tmp_path):
    """Copied away from the package, in a fresh interpreter without it on the path."""
    shutil.copytree(FOLDER, tmp_path / "check", ignore=shutil.ignore_patterns("__pycache__"))
    files = [tmp_path / f"{k}.json" for k, _ in enumerate(certificates)]
    for file, certificate in zip(files, certificates.values(), strict=True):
        certificate.write(file)
    command = [sys.executable, "-I", "check", *(f.name for f in files)]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert run.stdout.count("proved:") == len(files) == len(run.stdout.splitlines())
    files[0].write_text(files[0].read_text().replace("passive", "splendid"))
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 1
    assert run.stdout.splitlines()[0] == (
        "0.json: refused: changed since it was written, or too long"
    )
    module = [sys.executable, "-m", "teleopdesign.passivity.checker", str(files[1])]
    run = subprocess.run(module, capture_output=True, text=True)
    assert run.returncode == 0 and "proved:" in run.stdout and not run.stderr


def test_a_certificate_survives_its_file(certificates, tmp_path):
    for certificate in certificates.values():
        certificate.write(tmp_path / "c.json")
        assert read_certificate(tmp_path / "c.json").content == certificate.content


@pytest.mark.parametrize(
    "name",
    [
        "lugre 0",
        *(pytest.param(n, marks=pytest.mark.slow) for n in ("quantised 0", "motor 0")),
    ],
)
def test_forged_proofs_are_refused_with_a_digest_that_fits(certificates, name):
    """Weights, squares, storage, supply, assumptions: each change alone is noticed."""
    original = certificates[name].content
    for change in (
        _weight_doubled,
        _weight_negative,
        _term_left_out,
        _supply_taxed,
        _assumption_dropped,
        _example_outside,
        _proof_of_one_sign_missing,
    ):
        forged = copy.deepcopy(dict(original))
        change(forged)
        with pytest.raises(ModelError, match="certificate"):
            resealed(forged).check()


def _first(forged):
    return next(t for by_case in forged["proofs"].values() for t in by_case.values() if t)


def _weight_doubled(forged):
    terms = _first(forged)
    terms[0][0] = str(2 * sp.Rational(terms[0][0]))


def _weight_negative(forged):
    terms = _first(forged)
    terms.append(["-1", {}, "1"])
    terms.append(["1", {}, "1"])  # together nothing, but one weight is negative


def _term_left_out(forged):
    _first(forged).pop()


def _supply_taxed(forged):
    """As if the port gave a little more than it does."""
    forged["supply"] = (
        f"{forged['supply']} - {'d' if 'd' in {*forged['signals'], *forged['rates']} else 'v'}**2"
    )


def _assumption_dropped(forged):
    used = {f for by in forged["proofs"].values() for ts in by.values() for t in ts for f in t[1]}
    forged["nonnegative"].pop(next(n for n in forged["nonnegative"] if n in used))


def _example_outside(forged):
    name = next(n for n in forged["example"] if n.startswith(("f_D", "s1", "K", "F_S", "f_C")))
    forged["example"][name] = "-7"


def _proof_of_one_sign_missing(forged):
    forged["proofs"]["supply"].popitem()


s = sp.Symbol("s")


@pytest.fixture(scope="module")
def motions(tmp_path_factory):
    """A growing wave and a cycle as plain data."""
    folder = tmp_path_factory.mktemp("motions")
    claims = {
        "wave": positive_real((s**2 - sp.Rational(1, 10) * s + 1) / (s + 1) ** 2),
        "cycle": dahl_compensation(
            coulomb_level=0.5, compensator_level=0.6, compensator_stiffness=1e4
        ),
    }
    strokes = {}
    for name, claim in claims.items():
        path = folder / f"{name}.json"
        write_record(claim.record, path)
        assert read_record(path).replay() > 0
        strokes[name] = json.loads(path.read_text())
    return strokes
