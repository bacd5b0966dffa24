"""Texts that try to run, and a guard that sees whether any of them did."""

import builtins
import json
import os
import subprocess
import sys
import types

import pytest

#: part of every text that would run: neither a file, nor the environment, nor compiled code may
#: ever hold it
MARK = "CANARY_7f3"
_OS = f"__import__('os').environ.__setitem__('{MARK}', '1')"

#: that are no names: each would do something if it were taken for code, a format or a template
CODE = (
    f"f = 0.0\nimport os; os.environ['{MARK}'] = '1'\nf",
    f"f\n    import os; os.environ['{MARK}'] = '1'\n    f", _OS, f"x or {_OS}", f"x; {_OS}",
    f"x = {_OS} #", f"x): {_OS}; (", f"x, y={_OS}",
    f'"""\nimport os; os.environ["{MARK}"] = "1"\n"""', f"'''\n{_OS}\n'''", f"exec({_OS!r})",
    f"eval(compile({_OS!r}, '', 'eval'))", f"lambda: {_OS}", f"[{_OS} for _ in 'a']",
    f"{{x.__class__.__mro__[1].__subclasses__()}}{MARK}", f"{{0.__class__}}{MARK}",
    f"{{{{ cycler.__init__.__globals__.os.environ.update({MARK}='1') }}}}",
    f"{{% import 'os' as o %}}{MARK}", f"%({MARK})s %n", f"$(touch {MARK})", f"`touch {MARK}`",
    f"; touch {MARK};", f"../../{MARK}", f"<script>{MARK}</script>",
    f"!!python/object/apply:os.system ['touch {MARK}']", f"cos\nsystem\n(S'touch {MARK}'\ntR.",
    f"x\x07{MARK}\x1b[2J", f"x\u2028{MARK}", f"{MARK}\u00e9", f"1{MARK}", f"{MARK}-1", f"{MARK}.x",
    f"{MARK} x", f" {MARK}", f"{MARK * 20}", "",
)  # fmt: skip


def pairs(places, texts):
    """Texts at places, as parameters of a test.

    Plain are as many as it takes for every place and every text to occur; a quarter of the others
    is slow.
    """
    places, texts = list(places), list(texts)
    cases = []
    for i, place in enumerate(places):
        for j, text in enumerate(texts):
            plain = i == j % len(places) or j == i % len(texts)
            if plain or (i + j) % 4 == 0:
                marks = () if plain else pytest.mark.slow
                cases.append(pytest.param(place, text, id=f"{i}-{j}", marks=marks))
    return cases


def quoted(text):
    """A text as TOML (and JSON) writes it."""
    return json.dumps(text).replace("\x7f", "\\u007f")


def held(code):
    """Every text that compiled code holds."""
    yield from (str(name) for name in (*code.co_names, *code.co_varnames, code.co_name))
    for constant in code.co_consts:
        if isinstance(constant, types.CodeType):
            yield from held(constant)
        elif isinstance(constant, str | bytes):
            yield str(constant)


class Guard:
    """Raises where something runs that holds the mark, or where any program is started."""

    def __init__(self, monkeypatch, folder):
        self.folder, self.ran = folder, []
        for module, name in (
            (os, "system"),
            (os, "popen"),
            (os, "execv"),
            (os, "posix_spawn"),
            (subprocess, "Popen"),
        ):
            monkeypatch.setattr(module, name, self._refuse(name))
        for name in ("exec", "eval"):
            monkeypatch.setattr(builtins, name, self._watched(name, getattr(builtins, name)))
        monkeypatch.chdir(folder)
        monkeypatch.delenv(MARK, raising=False)

    def _refuse(self, name):
        def refuse(*arguments, **more):
            self.ran.append(name)
            raise AssertionError(f"{name} was called: {arguments}")

        return refuse

    def _watched(self, name, original):
        def watched(source, namespace=None, local=None):
            texts = held(source) if isinstance(source, types.CodeType) else [str(source)]
            if any(MARK in text for text in texts):
                self.ran.append(name)
                raise AssertionError(f"{name} of {source!r}")
            if namespace is None:
                frame = sys._getframe(1)
                namespace, local = frame.f_globals, frame.f_locals
            return original(source, namespace, local)

        return watched

    def check(self):
        """Nothing ran, nothing was touched."""
        assert self.ran == []
        assert MARK not in os.environ
        assert not any(MARK in path.name for path in self.folder.rglob("*"))
