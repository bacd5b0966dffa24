"""Certificates: a small program verifies them without the package, and refuses the rest."""

import ast
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
    absolutely_stable,
    any_environment,
    bounded_compensation,
    checker,
    dahl_compensation,
    delayed_small_motion,
    delayed_spring,
    lugre_passivity,
    passive,
    positive_real,
    quantised_spring,
    read_certificate,
    sampled_passivity,
    teleoperator_two_port,
)
from teleopdesign.realise.lti import S

FOLDER = Path(checker.__file__).parent

PROVED = {
    "impedance": lambda: positive_real(0.15 * S + 4 + 300 / S),
    "two-port": lambda: passive(teleoperator_two_port(master=S + 1, slave=S + 2, stiffness=10)),
    "stable two-port": lambda: absolutely_stable(
        teleoperator_two_port(master=S + 1, slave=S + 2, stiffness=10)
    ),
    "delayed coupling": lambda: delayed_spring(
        master_inertia=1, master_damping=2, slave_inertia=1, slave_damping=2, stiffness=9, delay=0.1
    ),
    "sampled": lambda: sampled_passivity(1000, damping=1, sample_time=1e-3),
    "bounded": lambda: bounded_compensation(coulomb_level=1, bound=0.9),
    "coulomb": lambda: dahl_compensation(
        coulomb_level=1, compensator_level=1, compensator_stiffness=1e4
    ),
    "presliding": lambda: dahl_compensation(
        coulomb_level=0.5,
        compensator_level=0.4,
        compensator_stiffness=1e3,
        presliding_stiffness=2e3,
        highest_level=0.7,
    ),
    "identical": lambda: dahl_compensation(
        coulomb_level=1, compensator_level=1, compensator_stiffness=1e3, presliding_stiffness=1e3
    ),
    "lugre": lambda: lugre_passivity(
        coulomb_level=0.5,
        static_level=0.6,
        stiffness=1e5,
        bristle_damping=20,
        viscous_damping=4,
        stribeck_velocity=0.005,
    ),
    "motor": lambda: any_environment(
        motor_level=1,
        link_level=2,
        transmission_stiffness=1e4,
        compensator_level=0.9,
        compensator_stiffness=1e4,
    ),
    "quantised": lambda: quantised_spring(
        stiffness=1000, damping=4, sample_time=1e-3, step=1e-4, coulomb_level=0.2
    ),
    "late": lambda: delayed_small_motion(
        damping=2, compensator_stiffness=5e3, delay=1e-3, presliding_stiffness=1e4
    ),
}


@pytest.fixture(scope="module")
def certificates():
    """Each certificate of the claims above, by name."""
    return {
        f"{name} {k}": certificate
        for name, claim in PROVED.items()
        for k, certificate in enumerate(claim().certificates)
    }


def resealed(content):
    """As a forger would: with a digest that fits."""
    body = {k: v for k, v in content.items() if k != "digest"}
    text = json.dumps(body, sort_keys=True)
    return Certificate({**body, "digest": hashlib.sha256(text.encode()).hexdigest()})


@pytest.mark.parametrize("file", sorted(FOLDER.glob("*.py")), ids=lambda file: file.name)
def test_the_checker_is_one_folder_that_imports_only_the_standard_library(file):
    """`__main__.py` imports its own package by a name that it has, and nothing else so."""
    source = file.read_text()
    nodes = [n for n in ast.walk(ast.parse(source)) if isinstance(n, ast.Import | ast.ImportFrom)]
    imports = [n for n in nodes if isinstance(n, ast.ImportFrom) and n.level]
    assert all(n.level == 1 and (FOLDER / f"{n.module}.py").is_file() for n in imports)
    names = {alias.name for n in nodes if isinstance(n, ast.Import) for alias in n.names}
    names |= {str(n.module) for n in nodes if isinstance(n, ast.ImportFrom) and not n.level}
    assert {n.split(".")[0] for n in names} <= sys.stdlib_module_names
    assert file.name == "__main__.py" or "importlib" not in names
    called = {n.id for n in ast.walk(ast.parse(source)) if isinstance(n, ast.Name)}
    assert not called & {"eval", "exec", "compile", "__import__", "getattr", "globals"}


def test_the_checker_is_short_enough_to_be_read_whole():
    """1900 lines in files of at most 300, each a concept with its proof."""
    lengths = [len(file.read_text().splitlines()) for file in FOLDER.glob("*.py")]
    assert sum(lengths) <= 1900 and max(lengths) <= 300


def test_every_proof_has_certificates_that_the_checker_accepts(certificates):
    assert len(certificates) >= len(PROVED)
    for name, certificate in certificates.items():
        assert certificate.check(), name


def test_the_statement_is_made_from_the_content_and_holds_its_values(certificates):
    """An edited title changes nothing that is called proved; an edited value changes the words."""
    for certificate in certificates.values():
        edited = {**certificate.content, "title": "passive within 500 N, whatever is done"}
        assert resealed(edited).check() == certificate.check()
        assert "500 N" not in resealed(edited).check()
    content = certificates["bounded 0"].content
    assert "f_D = 9/10" in resealed(content).check()
    content = {**content, "example": {**content["example"], "f_D": "1/5"}}
    assert "f_D = 1/5" in resealed(content).check()
    content = {**content, "example": {**content["example"], "f_D": "500"}}
    with pytest.raises(ModelError, match="example: enough does not hold"):
        resealed(content).check()


def test_the_statement_names_rates_supply_storage_and_what_is_assumed(certificates):
    statement = certificates["lugre 0"].check()
    for part in ("d/dt y = ", "V = y**2/(2*sigma_0)", "F_S - y >= 0", "g > 0", "sigma_0 = 100000"):
        assert part in statement
    statement = certificates["two-port 0"].check()
    assert "[[s + 1 + 10/s, -10/s], [-10/s, s + 2 + 10/s]] is positive real" in statement


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


def test_a_file_that_is_no_certificate_is_one_clear_line(tmp_path):
    (tmp_path / "c.json").write_text("{")
    with pytest.raises(ModelError, match=r"c\.json: refused: no certificate"):
        read_certificate(tmp_path / "c.json")


def test_any_change_breaks_the_digest(certificates):
    for certificate in certificates.values():
        content = {**certificate.content, "title": "something else"}
        with pytest.raises(ModelError, match="changed since it was written"):
            Certificate(content).check()


@pytest.mark.parametrize(
    "name",
    [
        "lugre 0",
        *(
            pytest.param(n, marks=pytest.mark.slow)
            for n in ("presliding 0", "coulomb 0", "quantised 0", "motor 0")
        ),
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


def test_a_storage_must_not_assume_what_a_state_does(certificates):
    """A bound on a state is an invariant to be shown; as a mere assumption it is refused."""
    forged = copy.deepcopy(dict(certificates["coulomb 0"].content))
    kept = forged["invariant"].pop("below")
    forged["nonnegative"]["below"] = kept["expression"]
    with pytest.raises(ModelError, match="a state or a sign is assumed"):
        resealed(forged).check()


def test_a_storage_must_not_depend_on_a_signal(certificates):
    forged = copy.deepcopy(dict(certificates["presliding 0"].content))
    forged["constants"].remove("sigma_p")
    forged["signals"].append("sigma_p")
    with pytest.raises(ModelError, match="depends on a signal"):
        resealed(forged).check()


def test_what_may_divide_by_zero_is_refused(certificates):
    forged = copy.deepcopy(dict(certificates["presliding 0"].content))
    del forged["positive"]["softer"]  # sigma_p = sigma_D, and V is infinite
    with pytest.raises(ModelError, match="divide by zero"):
        resealed(forged).check()


@pytest.mark.parametrize("impedance", ["s - 1", "1/(s**2 + 2*s + 1)", "-s", "1/s**2", "s**2", "-1"])
def test_an_impedance_that_is_not_positive_real_is_refused(impedance, certificates):
    forged = {**certificates["impedance 0"].content, "impedance": [[impedance]]}
    with pytest.raises(ModelError, match="certificate"):
        resealed(forged).check()


@pytest.mark.parametrize(
    "text",
    ["__import__('os').system('true')", "s.__class__", "(lambda: 1)()", "exit()", "1e3", "", "s s"],
)
def test_a_certificate_cannot_run_code(text, certificates):
    forged = {**certificates["impedance 0"].content, "impedance": [[text]]}
    with pytest.raises(ModelError, match="refused"):
        resealed(forged).check()


@pytest.mark.parametrize("expression", [sp.Float(0.5), sp.sqrt(2), sp.exp(S), 0.1 * S, sp.oo])
def test_only_rational_expressions_are_written(expression):
    from teleopdesign.passivity.claims.certificate import matrix_certificate

    with pytest.raises(ModelError, match="expected a rational expression"):
        matrix_certificate("not rational", [[expression]])
