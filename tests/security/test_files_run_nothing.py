"""No file that the package reads runs anything: texts that try are refused, or stay texts."""

import ast
import json
import os
import pickle
import signal
from contextlib import contextmanager
from types import SimpleNamespace

import numpy as np
import pytest
import sympy as sp
from measurement.rod_example import ROD, rod_columns, rows, write_rod
from security.hostile import CODE, MARK, quoted

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
from teleopdesign.diagrams.expressions import read_expression
from teleopdesign.diagrams.toml_writing import diagram_text
from teleopdesign.effects import load_effect
from teleopdesign.errors import ExperimentError, ModelError, TeleopDesignError
from teleopdesign.measurement import load_experiment
from teleopdesign.realise.laws import assignments

pytest.importorskip("h5py")  # asks the machine what it is when it is first loaded

SECONDS = 10  # s: none of these reads anything large


@contextmanager
def in_time(seconds=SECONDS):
    """Fails what hangs."""

    def late(*_):
        raise AssertionError(f"took more than {seconds} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def one_line(error):
    assert str(error).isprintable() and len(str(error)) < 1000
    return str(error)


#: where a name stands in a diagram's file; the same name at all places is one wiring
NAMES = {
    "title": "one body",
    "outside": "f",
    "motion": "x",
    "command": "u",
    "reaction": "f_k",
    "arm": "g",
    "place": "k",
    "body": "M",
    "spring": "Z",
    "law": "C",
}


def diagram_file(**names):
    """A diagram with everything that a file may hold, under these names."""
    n = {key: quoted(name) for key, name in {**NAMES, **names}.items()}
    return f"""\
[diagram]
name = {n["title"]}
measured = [{n["motion"]}]
[outside]
{n["outside"]} = "force"
[blocks.{n["body"]}]
kind = "moving"
motion = {n["motion"]}
command = {n["command"]}
loads = {{ {n["outside"]} = 1, {n["reaction"]} = 1, {n["arm"]} = 1 }}
driver = {n["outside"]}
axis = "prismatic"
inertia = 0.15
[blocks.{n["body"]}.effects.viscous]
damping = 2.0
[blocks.{n["spring"]}]
kind = "attached"
motion = {n["motion"]}
force = {n["reaction"]}
axis = "prismatic"
inertia = 0.1
[blocks.{n["law"]}]
kind = "control"
input = {n["motion"]}
output = {n["command"]}
motion = {n["motion"]}
law = "spring_damper"
parameters = {{ stiffness = -10, damping = -1 }}
[kinematics]
{n["place"]} = {quoted("0.1*sin(x)") if n["motion"] == '"x"' else quoted("0.5")}
[junctions]
{n["arm"]} = {{ {n["outside"]} = 0.5 }}
[pose]
{n["motion"]} = 0.1
[texts]
{n["motion"]} = {n["title"]}
"""


def test_the_file_that_is_spoilt_below_is_good(guard, tmp_path):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file())
    assert main(["derive", str(file)]) == 0


@pytest.mark.parametrize("place", [p for p in NAMES if p != "title"])
@pytest.mark.parametrize("text", CODE, ids=range(len(CODE)))
def test_a_name_in_a_diagrams_file_is_refused_in_one_line(guard, tmp_path, capsys, place, text):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file(**{place: text}), encoding="utf-8")
    with in_time():
        assert main(["derive", str(file)]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and said.startswith("teleopdesign: loop.toml: ")
    assert one_line(said.strip())


@pytest.mark.parametrize("text", CODE, ids=range(len(CODE)))
def test_a_diagrams_title_and_texts_stay_texts(guard, tmp_path, capsys, text):
    file = tmp_path / "loop.toml"
    file.write_text(diagram_file(title=text), encoding="utf-8")
    diagram = read_diagram(file)
    assert (diagram.name, diagram.texts["x"]) == (text, text)
    file.write_text(diagram_text(diagram), encoding="utf-8")
    assert read_diagram(file) == diagram
    with in_time():
        assert main(["derive", str(file), "--json", str(tmp_path / "d.json")]) == 0
    assert json.loads((tmp_path / "d.json").read_text())["diagram"] == text


KEYS = ("kind", "axis", "inertia", "law", "sign", "command", "effects", "series", "mass")


@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("text", CODE[:10], ids=range(10))
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


EXPRESSIONS = (
    *CODE,
    "().__class__.__bases__[0].__subclasses__()",
    "x.__class__",
    "x.diff",
    "getattr(x, 'diff')",
    "open('/etc/passwd')",
    "print(1)",
    "Symbol('x')",
    "sympify('x')",
    "f'{x}'",
    "b'x'",
    "'x' * 9999999",
    "(x := 1)",
    "x if x else x",
    "x and x",
    "not x",
    "~x",
    "x @ x",
    "x // 2",
    "x % 2",
    "x << 2",
    "*x",
    "x,",
    "...",
    "None",
    "await x",
    "sin(*x)",
    "sin(x=1)",
    "sin(**x)",
    "sin",
    "sin()",
    "lambda_(x)",
    "0x1for x",
    "1_0if x else 2",
)
#: these alone are expressions, of names that are given to nothing
PLAIN = ("sin", f"{MARK}-1", f" {MARK}")
LARGE = (
    "9**9**9**9",
    "10**10**10",
    "exp(exp(1e10))",
    "exp(1e10)",
    "(1+x)**100000",
    "((((x**64)**64)**64)**64)",
    "*".join(["x**64"] * 600),
    "sin(10**4000)",
    "sin(" + "9" * 4000 + ")",
    "9" * 4400,
    "1e999",
    "1e308*1e308",
    "x*1e308*1e308",
    "1e-300**-3",
    "(" * 200 + "x" + ")" * 200 + "*" + "sin(" * 70 + "x" + ")" * 70,
    "(" * 4000 + "x",
    "-" * 9000 + "x",
    "sin(" * 90 + "x" + ")" * 90,
    "x" * 10_001,
    "+".join(["x"] * 4999),
    "(a+b+c+d+e+f+g+h)**64",
    "*".join(f"(1+a{i})" for i in range(500)),
    "((x*exp(300))**64/x**63)**64",
    "+".join(f"1/{2 * i + 1}" for i in range(900)),
    "*".join(f"sqrt({10**17 + 7 * i})" for i in range(1, 400)),
    "cos(" * 58 + "1" + ")" * 58,
    "abs(sqrt(2)-sqrt(" * 20 + "3" + "))" * 20,
    "1/(x-x)",
    "0**-1",
    "tan(pi/2)",
    "(-8)**(1/3)",
    "asin(2)",
    "sqrt(-1)",
    "2**(2**(2**(2**(2**9))))",
    "factorial(99999)",
    "gamma(x)",
    "x**1e9",
    "x**-1000",
    "0.5**(-5000)",
    "exp(x)**100",
)


@pytest.mark.parametrize("text", EXPRESSIONS, ids=range(len(EXPRESSIONS)))
def test_an_expression_is_refused_where_it_is_none(guard, text):
    with in_time():
        if text in PLAIN:
            (symbol,) = read_expression(text, where="here").free_symbols
            assert symbol.name in text
            return
        with pytest.raises(ExperimentError) as caught:
            read_expression(text, where="here")
    assert one_line(caught.value).startswith("here: ")


@pytest.mark.parametrize("text", LARGE, ids=range(len(LARGE)))
def test_an_expression_that_would_fill_time_or_memory_is_refused_at_once(guard, text):
    with in_time(5), pytest.raises(ExperimentError) as caught:
        read_expression(text, where="here")
    assert len(one_line(caught.value)) < 300


def test_what_sympy_would_think_about_for_ever_is_given_up(guard):
    """Found by drawing texts: small, of moderate numbers, and without an end."""
    text = (
        "tan((csc(tan(asin((x/(tan(cot((x+0.5)))-(sqrt((y/64))+((7**64)+csc(1e300))))))))**((pi/"
        "(sin((sin(sec((z-z)))/(tan((pi*x))*(csc(1e300)*(y*z)))))-csc(sec(2))))*atan((x/(asin(("
        "asin((pi+x))/((z+x)+atan(3))))-(((sign(pi)-x)+((pi/3)-(y/y)))*cos(((1e300-0.5)**(x/y))))"
        "))))))"
    )
    with in_time(), pytest.raises(ExperimentError, match="here: .* takes sympy too long to read"):
        read_expression(text, where="here")
    assert read_expression("sqrt(sin(x)**2)", where="here") == sp.Abs(
        sp.sin(sp.Symbol("x", real=True))
    )


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
        lambda: Control("C", ANY, "x", "u", text),
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


def test_a_function_of_a_users_own_reaches_no_source(guard):
    """sympy would print its name into the source as it is."""
    hostile = sp.Function(CODE[0])(sp.Symbol("x", real=True))
    with pytest.raises(ModelError, match="no source") as caught:
        assignments({"y0": hostile}, {sp.Symbol("x", real=True): "x0"})
    one_line(caught.value)


#: what stands in an experiment's file
ENTRIES = (
    '"Vertical rod of a one-axis haptic interface"',
    '"prismatic"',
    "0.15",
    '"kg"',
    "false",
    "coulomb",
    "level",
    "device",
    '"t"',
    '"u"',
    '"mm"',
    "actuator_force",
    "5e-3",
    "20",
    '"Hz"',
    '"fit.csv"',
    '"check"',
    '"own"',
)
TITLE = ENTRIES[0]


@pytest.mark.parametrize("entry", ENTRIES)
@pytest.mark.parametrize("text", CODE[:12], ids=range(12))
def test_an_entry_of_an_experiment_is_refused_or_stays_a_text(guard, tmp_path, entry, text):
    folder = write_rod(tmp_path / "rod")
    file = folder / "experiment.toml"
    file.write_text(ROD.replace(entry, quoted(text), 1), encoding="utf-8")
    with in_time():
        if entry == TITLE:
            assert load_experiment(folder).title == text
            return
        with pytest.raises(TeleopDesignError) as caught:
            from teleopdesign.model import Model

            Model.from_experiment(load_experiment(folder))
    one_line(caught.value)


@pytest.mark.parametrize("text", [t for t in CODE if t.strip() == t and t and "\n" not in t])
def test_a_column_may_be_called_anything(guard, tmp_path, text):
    """A header is looked up as it stands, where a line of the table can hold it."""
    folder = write_rod(tmp_path / "rod")
    toml = ROD.replace('"x"', quoted(text))
    (folder / "experiment.toml").write_text(toml, encoding="utf-8")
    for name in ("fit.csv", "check.csv"):
        columns = rod_columns()
        columns = {
            f'"{text}"' if k == "x" and '"' not in text else k: v for k, v in columns.items()
        }
        (folder / name).write_text(rows(columns), encoding="utf-8")
    with in_time():
        try:
            found = load_experiment(folder)
            assert found.channels["device.position"].column == text
        except ExperimentError as error:
            one_line(error)


class Runs:
    """What a pickle of it does when it is read."""

    def __reduce__(self):
        return (__import__("os").putenv, (MARK, "1"))


@pytest.mark.parametrize(
    "name", ["r.csv", "r.csv.gz", "r.mat", "r.h5", "r.parquet", "r.npz", "r.pkl"]
)
@pytest.mark.parametrize("kind", ["pickle", "npz", "mat"])
def test_a_record_that_holds_objects_is_refused_in_one_line(
    guard, tmp_path, monkeypatch, name, kind
):
    from scipy.io import savemat

    def refuse(*_, **__):
        raise AssertionError("a pickle was read")

    folder = write_rod(tmp_path / "rod")
    (folder / "experiment.toml").write_text(ROD.replace("fit.csv", name))
    content = np.array([Runs()] * 100, dtype=object)
    file = folder / name
    if kind == "pickle":
        file.write_bytes(pickle.dumps(content))
    elif kind == "npz":
        with file.open("wb") as stream:
            np.savez(stream, t=content, u=content, x=content, f_h=content)
    else:
        with file.open("wb") as stream:
            savemat(
                stream, {n: np.array([{"a": 1}, "b"], dtype=object) for n in ("t", "u", "x", "f_h")}
            )
    for read in ("load", "loads", "Unpickler"):
        monkeypatch.setattr(pickle, read, refuse)
    with in_time(), pytest.raises(ExperimentError) as caught:
        load_experiment(folder)
    one_line(caught.value)


def number(value, unit="N"):
    return {"value": value, "stderr": 0.01, "unit": unit}


def answer(**changed):
    """An answer of a diagnosis in which one thing is another text."""
    c = {
        "verdict": "effects_missing",
        "effect": "presliding",
        "at": "device",
        "body": "device",
        "parameter": "coulomb.level",
        "own": "stiffness",
        "value": 0.5,
        "stderr": 0.01,
        "unit": "kg",
    } | changed
    inertia = {"value": c["value"], "stderr": c["stderr"], "unit": c["unit"]}
    place = {"effect": c["effect"], "at": c["at"]}
    return {
        "verdict": c["verdict"],
        "missing": [place],
        "ladder": [{"added": None}, {"added": place}],
        "model_parameters": {
            f"{c['body']}.inertia": inertia,
            "device.coulomb.level": number(0.5),
            f"device.{c['parameter']}": number(0.4),
        },
        "candidates": [{**place, "parameters": {c["own"]: number(2e4, "N/m")}}],
    }


@pytest.mark.parametrize("key", ["effect", "at", "body", "parameter", "own", "value", "stderr"])
@pytest.mark.parametrize("text", CODE[:12], ids=range(12))
def test_an_entry_of_an_answer_is_refused_in_one_line(guard, tmp_path, capsys, key, text):
    from teleopdesign.design import read_answer
    from teleopdesign.diagnose import Diagnosis  # noqa: F401, loaded before what reads is watched

    path = tmp_path / "answer.json"
    path.write_text(json.dumps(answer(**{key: text})))
    with in_time():
        assert main(["passivity", str(path), "--dahl", "0.4", "1e4"]) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and one_line(said.strip())
        with pytest.raises(ExperimentError) as caught:
            read_answer(path, load_experiment(write_rod(tmp_path / "rod")))
    one_line(caught.value)


@pytest.mark.parametrize(
    "content",
    ["[" * 100_000, "{}", "[]", "1", '"x"', "NaN", '{"model_parameters": 1e999}', "\x00",
     '{"model_parameters": [], "candidates": {}, "missing": 1, "ladder": 2}',
     '{"model_parameters": {"device.inertia": 3}, "candidates": [4], "missing": [], "ladder": [5]}',
     '{"model_parameters": {}, "candidates": [], "missing": [], "ladder": []}',
     '{"model_parameters": {"a": {"value": ' + "9" * 5000 + "}}}"],
    ids=range(12),
)  # fmt: skip
def test_another_content_of_an_answer_is_refused_in_one_line(guard, tmp_path, capsys, content):
    from teleopdesign.design import read_answer

    path = tmp_path / "answer.json"
    path.write_text(content)
    with in_time():
        assert main(["passivity", str(path), "--dahl", "0.4", "1e4"]) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1 and one_line(said.strip())
        with pytest.raises(ExperimentError) as caught:
            read_answer(path, load_experiment(write_rod(tmp_path / "rod")))
    one_line(caught.value)


TITLES = (*CODE, '"' * 7, "\\", "\\N{x}", '\\"""', "'''" + '"""')


@pytest.mark.parametrize("text", TITLES, ids=range(len(TITLES)))
def test_a_written_effect_file_holds_titles_as_text_alone(tmp_path, monkeypatch, text):
    """It is code that is run later: titles and sentences with file names stand in its docstring."""
    from teleopdesign.unexplained import effect_file
    from teleopdesign.unexplained.shapes import SHAPES

    shape = next(s for s in SHAPES if s.variable is None and s.carrier.name == "force")
    dependence = SimpleNamespace(
        shape=shape, explained=0.5, coefficients=np.array([0.3]), knots=np.array([0.0])
    )
    curve = SimpleNamespace(x=np.array([0.0, 1.0]))
    described = SimpleNamespace(dependence=dependence, formula=None, sentence=text, curve=curve)
    experiment = SimpleNamespace(title=text)
    prepared = SimpleNamespace(experiment=experiment, of=lambda use: (), bandwidth=20.0)
    monkeypatch.setattr(effect_file, "scales", lambda *_: {"force": 1.0})
    path = tmp_path / "made.py"
    effect_file.write_effect(path, SimpleNamespace(axis="prismatic"), described, prepared)
    kinds = [type(node).__name__ for node in ast.parse(path.read_text()).body]
    assert kinds == ["Expr", "ImportFrom", "FunctionDef", "Assign"]
    content = ast.parse(path.read_text())
    content.body[0] = ast.Pass()
    assert MARK not in ast.unparse(content)
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv(MARK, raising=False)
    assert load_effect(path).role == "force"  # it is run here, the text in its docstring is not
    assert MARK not in os.environ and len(list(tmp_path.iterdir())) == 1
