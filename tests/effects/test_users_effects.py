"""A user's own effect file takes the way of the catalogue's, and a mistake in it is one line."""

import re
from dataclasses import fields

import pytest
import sympy as sp
from users_effect import SOURCE

from teleopdesign.base.errors import ModelError
from teleopdesign.effects import (
    EFFECTS,
    SIGNALS,
    FitSearch,
    catalogue,
    load_effect,
)


@pytest.fixture
def users_effect(tmp_path):
    file = tmp_path / "own_drag.py"
    file.write_text(SOURCE)
    return file


def test_a_users_file_becomes_an_effect_under_the_files_name(users_effect):
    known = catalogue([users_effect])
    assert set(known) == {*EFFECTS, "own_drag"}
    effect = known["own_drag"]
    assert effect.title == "Own drag: a force in proportion to the square of velocity."
    v, drag = SIGNALS["velocity"], effect.symbols()["drag"]
    assert effect.expression() == drag * v * sp.Abs(v)


def test_a_users_effect_takes_the_place_of_one_of_the_same_name(tmp_path):
    file = tmp_path / "viscous.py"
    file.write_text(SOURCE)
    assert "drag" in catalogue([file])["viscous"].parameters
    assert "damping" in EFFECTS["viscous"].parameters, "the package's own stays"


BAD = {
    "no EFFECT": ("EFFECT = Effect(", "OTHER = Effect(", "found no EFFECT"),
    "wrong role": (
        'role="force"',
        'role="forse"',
        'role: found the text "forse", expected one of .*mean "force"',
    ),
    "unknown signal": ("now.velocity *", "now.velocty *", "velocty"),
    "unknown parameter": ("p.drag", "p.dragg", "dragg"),
    "a symbol of its own": (
        "return p.drag",
        "import sympy\n    return sympy.Symbol('mystery') * p.drag",
        "law uses mystery",
    ),
    "a law in text": ("return p.drag", "return '1' or p.drag", "law: SympifyError"),
    "syntax": ("def law(now, p):", "def law(now, p)", "SyntaxError"),
    "import": ("from teleopdesign import Effect", "from teleopdesign import Efect", "Efect"),
    "failure of its own": ("def law", "1 / 0\n\n\ndef law", "ZeroDivisionError"),
    "absent names no parameter": ('absent={"drag"', 'absent={"drg"', 'absent: no parameter "drg"'),
    "a start of a later parameter": (
        'force per velocity squared"',
        'force per velocity squared", search=__import__("teleopdesign").FitSearch(of="later")',
        'drag: FitSearch.of="later".: expected a parameter before drag',
    ),
    "argument left out": ('    absent={"drag": 0.0},\n', "", "absent"),
}


@pytest.mark.parametrize("mistake", BAD)
def test_a_mistake_in_an_effect_file_is_one_line(users_effect, mistake):
    old, new, expected = BAD[mistake]
    text = users_effect.read_text()
    assert old in text
    users_effect.write_text(text.replace(old, new, 1))
    with pytest.raises(ModelError) as caught:
        load_effect(users_effect)
    message = str(caught.value)
    assert message.startswith(f"{users_effect}: ")
    assert len(message.splitlines()) == 1
    assert re.search(expected, message), message


@pytest.mark.parametrize("field", [f.name for f in fields(FitSearch)])
def test_an_older_file_is_refused_with_what_to_write_instead(users_effect, field):
    text = users_effect.read_text()
    older = re.sub(r"(Parameter\([^)]*)\)", rf"\1, {field}=0)", text)
    assert older != text
    users_effect.write_text(older)
    with pytest.raises(ModelError, match=rf"search=FitSearch\({field}=") as refusal:
        load_effect(users_effect)
    assert "\n" not in str(refusal.value)
