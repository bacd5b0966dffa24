"""No diagram runs anything, read or made in Python: texts that try are refused, or stay texts."""

import json

import pytest
import sympy as sp
from clock import in_time
from security.diagram_file import NAMES, diagram_file, one_line
from security.hostile import CODE, pairs, quoted

from teleopdesign.base.errors import ModelError
from teleopdesign.cli import main
from teleopdesign.controllers import from_control
from teleopdesign.diagrams import (
    ANY,
    Arm,
    Attached,
    Control,
    Diagram,
    Junction,
    Kinematics,
    Moving,
    read_diagram,
)
from teleopdesign.diagrams.toml_writing import diagram_text
from teleopdesign.realise.laws import assignments


def test_the_file_that_is_spoilt_below_is_good(guard, tmp_path):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file())
    assert main(["derive", str(file)]) == 0


@pytest.mark.parametrize(("place", "text"), pairs((p for p in NAMES if p != "title"), CODE))
def test_a_name_in_a_diagrams_file_is_refused_in_one_line(guard, tmp_path, capsys, place, text):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file(**{place: text}), encoding="utf-8")
    with in_time():
        assert main(["derive", str(file)]) == 2
    output = capsys.readouterr().err
    assert output.count("\n") == 1 and output.startswith("teleopdesign: loop.toml: ")
    assert one_line(output.strip())


@pytest.mark.parametrize("text", CODE, ids=range(len(CODE)))
def test_a_diagrams_title_and_texts_stay_texts(guard, tmp_path, capsys, text):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file(title=text), encoding="utf-8")
    diagram = read_diagram(file)
    assert (diagram.name, diagram.texts["x"]) == (text, text)
    file.write_text(diagram_text(diagram), encoding="utf-8")
    assert read_diagram(file) == diagram


# the titles alone differ: a few go all the way through a command
@pytest.mark.parametrize("text", CODE[::6], ids=range(len(CODE[::6])))
def test_a_command_takes_a_diagrams_title_for_a_text(guard, tmp_path, capsys, text):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file(title=text), encoding="utf-8")
    with in_time():
        assert main(["derive", str(file), "--json", str(tmp_path / "d.json")]) == 0
    assert json.loads((tmp_path / "d.json").read_text())["diagram"] == text


KEYS = ("kind", "axis", "inertia", "law", "sign", "command", "effects", "series", "mass")


@pytest.mark.parametrize(("key", "text"), pairs(KEYS, CODE[:10]))
def test_a_value_of_a_block_is_refused_in_one_line(guard, tmp_path, capsys, key, text):
    file = tmp_path / "loop.toml"
    block = "law" if key in ("law", "series") else "body"
    lines = [line for line in diagram_file().split("\n") if not line.startswith(f"{key} =")]
    at = lines.index(f'[blocks."{NAMES[block]}"]')
    lines.insert(at + 1, f"{key} = {quoted(text)}")
    file.write_text("\n".join(lines), encoding="utf-8")
    with in_time():
        assert main(["derive", str(file)]) == 2
    assert one_line(capsys.readouterr().err.strip())


@pytest.mark.parametrize("text", CODE, ids=range(len(CODE)))
def test_parts_given_in_python_check_their_names_and_take_no_text_for_an_expression(guard, text):
    odd = sp.Symbol(text or "1", real=True)
    makers = (
        lambda: Moving(text, ANY, "x", "u", {}, "u"),
        lambda: Moving("M", ANY, text, "u", {}, "u"),
        lambda: Moving("M", ANY, "x", text, {}, "u"),
        lambda: Moving("M", ANY, "x", "u", {text: 1}, "u"),
        lambda: Moving("M", ANY, "x", "u", {"f": text}, "u"),
        lambda: Attached("Z", ANY, "x", text),
        lambda: Control("C", ANY, text, "u", "x"),
        lambda: Control("C", ANY, "x", text, "x"),
        lambda: Control("C", ANY, "x", "u", text or "1"),  # a blank motion is none
        lambda: Junction(text, {"x": 1}),
        lambda: Junction("y", {text: 1}),
        lambda: Junction("y", {"x": text}),
        lambda: Junction("y", {"x": odd}),
        lambda: Kinematics("y", text),
        lambda: Kinematics("y", sp.sin(odd)),
        lambda: Diagram("d", (), (), {text: "force"}, ()),
        lambda: Diagram("d", (), (), {}, (), {text: "a text"}),
        lambda: Diagram("d", (), (), {}, (), pose={text: 1.0}),
        lambda: Arm((), (text,)),
        lambda: from_control(None, name=text),
    )
    for make in makers:
        with in_time(), pytest.raises(ModelError) as caught:
            make()
        one_line(caught.value)


def test_a_function_of_the_user_reaches_no_source(guard):
    """sympy would print its name into the source as it is."""
    hostile = sp.Function(CODE[0])(sp.Symbol("x", real=True))
    with pytest.raises(ModelError, match="no source") as caught:
        assignments({"y0": hostile}, {sp.Symbol("x", real=True): "x0"})
    one_line(caught.value)
