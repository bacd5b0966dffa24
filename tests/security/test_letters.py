"""Letters that look like others, words that mean something elsewhere, what a terminal would obey.

Python reads identifiers in their NFKC form: a full-width sin is sin to it.
"""

import json

import pytest
from clock import in_time
from passivity.small_certificates import impedance, sealed, storage
from security.diagram_file import diagram_file, one_line

from teleopdesign.base.errors import ExperimentError
from teleopdesign.cli import main
from teleopdesign.diagrams.expressions import read_expression

NAMES = ["ｆ", "f\u200b", "f\u202e", "\u0131", "x\u0301", "ſ", "ª", "𝐟"]
#: that Python's own reader takes for something else, or that only look like it
TEXTS = [
    "ｓｉｎ(x)", "0.1*𝒙", "x²", "½", "sin\u2061(x)", "0.1\u2212x", "１+x", "x\u00a0+1", "ª", "π",
]  # fmt: skip
#: of Python, sympy, numpy, the kernel and generated source
WORDS = ["__builtins__", "__import__", "np", "exp", "S", "I", "E", "sin", "print", "self", "numba",
         "math", "output", "state", "late_0", "__class__", "Symbol", "oo", "x0"]  # fmt: skip


@pytest.mark.parametrize("text", TEXTS)
def test_an_expression_holds_plain_letters_alone(guard, text):
    with pytest.raises(ExperimentError) as caught:
        read_expression(text, where="here")
    assert one_line(caught.value).startswith("here: ")


@pytest.mark.parametrize("name", NAMES)
def test_a_name_holds_plain_letters_alone(guard, tmp_path, capsys, name):
    path = tmp_path / "d.toml"
    text = diagram_file(outside="F_1").replace('"F_1"', f'"{name}"')
    path.write_text(text, encoding="utf-8")
    assert main(["derive", str(path)]) == 2
    assert one_line(capsys.readouterr().err.strip())


def derived_with(name, folder):
    """What is derived of a diagram whose names are made of this one, with NAME for it."""
    path = folder / f"{name}.toml"
    path.write_text(diagram_file(body=name, outside=f"{name}_f", law=f"{name}2"))
    assert main(["derive", str(path), "--json", str(folder / "d.json")]) == 0
    return json.loads((folder / "d.json").read_text().replace(name, "NAME"))


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return derived_with("plain", tmp_path_factory.mktemp("plain"))


@pytest.mark.parametrize("word", WORDS)
def test_a_name_that_means_something_elsewhere_is_a_name(guard, plain, tmp_path, word):
    """The same answer as with plain names."""
    assert derived_with(word, tmp_path).keys() == plain.keys()


def test_no_signal_is_called_as_the_number_that_expressions_have(guard, tmp_path, capsys):
    """0.1*sin(pi) of a position "pi" would be 0, in silence."""
    path = tmp_path / "d.toml"
    path.write_text(diagram_file(motion="pi").replace('"0.5"', '"0.1*sin(pi)"'))
    assert main(["derive", str(path)]) == 2
    assert '"pi"' in capsys.readouterr().err


NUMBERS = [
    "٣*s+1",
    "１*s + 1",
    "1_000*s+1",
    "s\u200b+1",
    "s+1 # comment",
    "s;s",
    "s\n+1",
    "s\t+1\v",
]


@pytest.mark.parametrize("text", NUMBERS)
def test_a_certificate_holds_plain_digits_and_signs_or_is_refused(guard, tmp_path, capsys, text):
    path = tmp_path / "c.json"
    path.write_text(json.dumps({"claims": [{"statement": "x", "certificates": [impedance(text)]}]}))
    with in_time():
        code = main(["passivity", "--check", str(path)])
    output = capsys.readouterr()
    if code == 0:  # white space between two signs changes nothing
        assert text.isascii() and not any(c in text for c in "#;_") and "proved" in output.out
    else:
        assert one_line(output.err.strip())


@pytest.mark.parametrize(
    "text", ["\x1b[2J\x1b]0;x\x07 proved", "\u202edevorp", "\ud800", "a\rb\nc"]
)
def test_no_text_of_a_file_acts_on_a_terminal(guard, tmp_path, capsys, text):
    path = tmp_path / "c.json"
    for certificate in (sealed({**storage(), "title": text}), storage(constants=[text])):
        content = {"claims": [{"statement": text, "certificates": [certificate]}]}
        path.write_text(json.dumps(content))
        with in_time():
            main(["passivity", "--check", str(path)])
        output = "".join(capsys.readouterr())
        assert all(line.isprintable() for line in output.split("\n"))
        assert "\u202e" not in output
