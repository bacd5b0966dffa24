"""The checker of certificates against files that are made to run code, or to hang."""

import copy
import os
import random
import re
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from clock import takes_less_than
from passivity.certificate_attack import falsified
from passivity.small_certificates import impedance, paths_of, sealed, storage

from teleopdesign.passivity.checker import Refused, check


def test_the_small_certificate_is_true_and_accepted():
    assert "p*v + b*v**2" in check(storage())
    assert falsified(storage(), random.Random(0)) is None


CODE = [
    "__import__('os').system('touch canary')", "open('canary','w')", "k.__class__.__mro__",
    "exec('1')", "lambda: 1", "k[0]", "k if k else k", "[k for k in k]", "k;k", "k\n=k", "`k`",
    "k@k", "k//k", "k%k", "k<k", "k.real", "f(k)", "k(k)", "'k'", "{k}", "k!", "\u212a",
    "k\u00b2", "\uff11", "1_000", "0x10", "1e3", "1j", ".5", "1.", "", " ", "()", "k k", "2k",
    "k**k", "k**(1/2)", "k**0.5", "2**2**2", "k**-", "k**(2", "--k", "k*-k", "nan", "oo",
    "zoo", "pi", "sqrt(k)", "__builtins__", "sign_k",
]  # fmt: skip
SLOW = [
    "9**9**9**9", "exp(exp(1e10))", "(1+v)**100000", "(1+v)**4000", "(" * 40000 + "v" + ")" * 40000,
    "-" * 90000 + "v", "9" * 90000, "(((9**4000)**4000)**4000)", "(1+v+k+b+p)**300",
    "*".join(["(1+v)"] * 15000), "*".join(["9999999999"] * 8000),
    "+".join(f"v**{n}*b**{n % 70}" for n in range(6000)), "v**3999/7+" * 4000 + "v",
    "1/(" + "+".join(f"v**{n}*k**{n % 70}" for n in range(4000)) + ")",
]  # fmt: skip


def fields(text):
    """A file with the text at each place where a text is read."""
    by_signs = {"1": [["1", {}, text]], "-1": [["1", {}, text]]}
    proofs = storage()["proofs"]
    return [
        storage(supply=text),
        storage(storage=text),
        storage(rates={"p": text}),
        storage(positive={"k": "k", "odd": text}),
        storage(nonnegative={"b": "b", "odd": text}),
        storage(invariant={"h": {"expression": text, "rate": "0"}}),
        storage(invariant={"h": {"expression": "p", "rate": text}}),
        storage(proofs={**proofs, "supply": by_signs}),
        storage(proofs={**proofs, "supply": {"1": [[text, {}, "1"]], "-1": []}}),
        storage(proofs={**proofs, "supply": {"1": [["1", {text: 1}, "1"]], "-1": []}}),
        storage(example={"k": text, "b": "1", "v": "1"}),
        storage(constants=["k", text]),
        storage(signals=["b", "v", text]),
        storage(signs=[text]),
        storage(kind=text),
        impedance(text),
    ]


def test_no_text_in_any_field_runs_or_is_accepted(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for text in CODE:
        plain = text in ("nan", "oo", "zoo", "pi")  # which may be declared, as any other word
        for content in fields(text):
            if plain and text in content.get("constants", []) + content.get("signals", []):
                continue
            with pytest.raises(Refused) as problem:
                check(content)
            assert "\n" not in str(problem.value) and len(str(problem.value)) < 250
    assert not os.listdir(tmp_path)


def test_names_of_a_certificate_cannot_smuggle_in_code(tmp_path, monkeypatch):
    """Names that allow themselves: what ran a shell command when texts were given to sympy."""
    monkeypatch.chdir(tmp_path)
    text = "k.__class__.__base__.__subclasses__()[0].__init__.__globals__['os'].system('touch x')"
    for names in (re.findall(r"[A-Za-z_]\w*|[^\w\s+*/()-]", text), ["__globals__"], ["."], ["["]):
        for content in (
            storage(constants=["k", *names], supply=text),
            storage(signals=["b", "v", *names], supply=text),
            storage(rates={"p": "k*v", **{n: "0" for n in names}}, supply=text),
            storage(signs=["v", *names], supply=text),
            storage(symbols=names, supply=text),
        ):
            with pytest.raises(Refused):
                check(content)
    assert not os.listdir(tmp_path)


#: of `fields`: a storage, a square, a number, an impedance. Texts that take seconds
#: each are tried there alone: the same function reads the others, and took the same time
READERS = (1, 7, 10, 15)


@pytest.mark.parametrize(
    ("which", "where"),
    [
        *((n, range(16)) for n in (0, 1, 2, 4, 5, 6, 7)),
        *(pytest.param(n, READERS, marks=pytest.mark.slow, id=str(n)) for n in (3, *range(8, 14))),
    ],
)
def test_nothing_takes_ten_seconds_or_a_gigabyte(which, where):
    # the most memory that this process ever had: tests before this one may have taken more
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    files = fields(SLOW[which])
    for content in (files[i] for i in where):
        with takes_less_than(10):
            try:
                check(content)
            except Refused as problem:
                assert "\n" not in str(problem)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < before + 1e6  # kB


ODD = [
    None, 1, 1.5, True, [], {}, "x", [1], [[]], {"a": 1}, {"": ""}, {"v": {}}, ["v", "v"],
    "9" * 60,
]  # fmt: skip


@pytest.mark.slow
def test_wrong_types_deeper_inside_are_one_line():
    """Each value of the plain data replaced by each odd one."""
    count = 0
    for path in paths_of(storage()):
        for odd in ODD:
            content = copy.deepcopy(storage())
            inner = content
            for step in path[:-1]:
                inner = inner[step]
            if path[0] == "digest" or inner[path[-1]] == odd:
                continue
            inner[path[-1]] = odd
            content = sealed(content)
            try:
                check(content)
            except Refused as problem:
                assert "\n" not in str(problem)
                count += 1
            else:
                assert falsified(content, random.Random(1)) is None
    assert count > 300


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("{", "no certificate"),
        ("[" * 100_000, "no certificate"),
        ('{"a":' * 100_000, "no certificate"),
        ("9" * 100_000, "no certificate"),
        ("[1, 2]", "expected dict"),
        ('{"kind": NaN}', "expected str"),
        ('{"kind": 1e999}', "expected str"),
        ('{"kind": "storage", "kind": "storage"}', "a field twice"),
        ("\udcff", "no certificate"),
        (" " * 2_000_001, "too long"),
    ],
)
def test_a_file_of_any_content_is_one_line_and_status_1(text, message, tmp_path):
    source = Path(sys.modules[check.__module__].__file__).parent
    (tmp_path / "c.json").write_bytes(text.encode("utf-8", "surrogateescape"))
    command = [sys.executable, "-I", str(source), str(tmp_path / "c.json")]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert run.returncode == 1 and not run.stderr
    assert len(run.stdout.splitlines()) == 1 and message in run.stdout


def test_a_certificate_in_deep_or_odd_python_data_is_refused():
    deep = []
    for _ in range(100_000):
        deep = [deep]
    for odd in (deep, {1: 2}, {"v": object()}, float("nan"), b"x", (1,), {("a",): 1}):
        for content in (odd, {**storage(), "proofs": odd}, {**storage(), "example": odd}):
            with pytest.raises(Refused):
                check(content)
    while deep:  # or its end is a recursion of its own
        deep = deep[0]
