"""Whatever changes the numbers of a study makes another study; nothing else does.

The code below has no file, as at a prompt, in a notebook and in `python -`.
"""

import sys
from types import ModuleType

import pytest

import teleopdesign as td
from teleopdesign.base.errors import ExperimentError
from teleopdesign.studies.fingerprint import fingerprint

#: a model or measure f, and the same one with another result: `old` -> `new`
CHANGES = {
    "method of a result": ("def f(s): return s.max()", "max", "min"),
    "set": ("def f(s): return s in {1, 2}", "2", "3"),
    "constant above": ("K = 1\ndef f(s): return K", "1", "2"),
    "instance called": ("class C:\n def __call__(self, s): return 1\nf = C()", "1", "2"),
    "method bound": ("class C:\n def g(self, s): return 1\nf = C().g", "1", "2"),
    "value of a class": ("class C:\n k = 1\ndef f(s): return C.k", "1", "2"),
    "slots": (
        "class C:\n __slots__ = ('k',)\n def __call__(self, s): return self.k\nf = C()\nf.k = 1",
        "k = 1",
        "k = 2",
    ),
    "data class": (
        "from dataclasses import dataclass\n@dataclass\nclass C:\n k: int = 1\n"
        " def __call__(self, s): return 5\nf = C()",
        "5",
        "6",
    ),
    "argument held": (
        "from functools import partial\ndef g(s, k): return k\nf = partial(g, k=3)",
        "3",
        "4",
    ),
    "compiled": ("from numba import njit\n@njit\ndef f(s): return 1", "1", "2"),
    "long labelled array": (
        "import xarray as xr, numpy as np\nK = np.arange(5000.0)\nK[2500] = 1\n"
        "K = xr.DataArray(K)\ndef f(s): return K",
        "= 1",
        "= 2",
    ),
}


@pytest.fixture(autouse=True)
def prompt(monkeypatch):
    """A prompt has no file; pytest, where it runs the tests itself, has one."""
    monkeypatch.setitem(sys.modules, "__main__", ModuleType("__main__"))


def at_prompt(text):
    names = {"__name__": "__main__"}
    exec(text, names)
    return names["f"]


@pytest.mark.parametrize("kind", CHANGES)
def test_a_changed_result_makes_another_study(kind):
    text, old, new = CHANGES[kind]
    assert old in text
    first = fingerprint(at_prompt(text))
    assert fingerprint(at_prompt(text)) == first
    assert fingerprint(at_prompt(text.replace(old, new, 1))) != first


@pytest.mark.parametrize(
    "text",
    [
        "import gain\ndef f(a): return gain.of(a)",
        "def f(a):\n import gain\n return gain.of(a)",
        "def f(a):\n from gain import of\n return of(a)",
    ],
)
def test_a_changed_module_of_the_user_makes_another_study(text, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    texts = []
    for factor in (2, 2, 3):
        (tmp_path / "gain.py").write_text(f"def of(a): return a * {factor}\n")
        monkeypatch.delitem(sys.modules, "gain", raising=False)
        texts.append(fingerprint(at_prompt(text)))
    assert texts[0] == texts[1] != texts[2]
    monkeypatch.delitem(sys.modules, "gain", raising=False)


def test_comments_do_not_make_another_study():
    before, after = "def f(s):\n return s", "# of a study\ndef f(s):\n\n return s  # as it is"
    assert fingerprint(at_prompt(before)) == fingerprint(at_prompt(after))


def test_a_measure_changed_at_a_prompt_is_not_answered_from_the_file(tmp_path):
    """The file of the largest value was the answer to the least one."""

    def study(text):
        axes, out = {"a": [1.0, 2.0]}, tmp_path / "study.nc"
        return td.study(at_prompt("def f(a): return [a, -a]"), axes, measures={"m": text}, out=out)

    code = "import numpy as np\ndef f(values): return float(np.array(values).max())"
    study(at_prompt(code))
    with pytest.raises(ExperimentError, match="holds another study"):
        study(at_prompt(code.replace("max", "min")))
