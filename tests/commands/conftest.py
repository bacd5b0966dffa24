"""What tests of commands share: a copy of the rod, cut short, and a catalogue of few effects."""

import shutil
from pathlib import Path

import pytest

from teleopdesign import EFFECTS

FEW = ("coulomb", "viscous", "stribeck", "presliding", "bias", "spring")


@pytest.fixture
def few(monkeypatch):
    """A catalogue of few effects, so that a diagnosis takes a second."""
    from teleopdesign import effects

    known = effects.catalogue
    monkeypatch.setattr(
        effects,
        "catalogue",
        lambda extra=(): {n: e for n, e in known(extra).items() if n in FEW or n not in EFFECTS},
    )


@pytest.fixture
def rod(short_rod, tmp_path):
    """A copy of it."""
    return Path(shutil.copytree(short_rod, tmp_path / "rod"))


@pytest.fixture
def refused(capsys):
    """Runs a command that must be refused with status 2; its one line on standard error."""
    from teleopdesign.cli import main

    def run(*arguments):
        assert main([str(a) for a in arguments]) == 2
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == 1 and lines[0].startswith("teleopdesign: "), lines
        return lines[0]

    return run
