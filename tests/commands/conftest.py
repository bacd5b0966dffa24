"""What tests of commands share: a copy of the rod, cut short, and a catalogue of few effects."""

import shutil
from contextlib import redirect_stdout
from io import StringIO
from pathlib import Path

import pytest

FEW = ("coulomb", "viscous", "stribeck", "presliding", "bias", "spring")


@pytest.fixture
def few(choose_from):
    """A catalogue of few effects, so that a diagnosis takes a second."""
    choose_from(FEW)


@pytest.fixture
def rod(short_rod, tmp_path):
    """A copy of it."""
    return Path(shutil.copytree(short_rod, tmp_path / "rod"))


@pytest.fixture(scope="session")
def diagnosed(short_rod, tmp_path_factory):
    """(folder with the rod and with its answer in a folder of its own, the long text of it)"""
    from teleopdesign.cli import main

    folder, text = tmp_path_factory.mktemp("diagnosed"), StringIO()
    rod = shutil.copytree(short_rod, folder / "rod")
    (folder / "saved").mkdir()
    options = ["--json", str(folder / "saved" / "answer.json"), "--verbose"]
    with redirect_stdout(text):
        assert main(["diagnose", str(rod), "--only", "stribeck", *options]) == 0
    return folder, text.getvalue()


@pytest.fixture
def answer(diagnosed, rod, tmp_path):
    """A copy of that answer, beside a copy of the rod, where it says that the rod is."""
    return Path(shutil.copytree(diagnosed[0] / "saved", tmp_path / "saved")) / "answer.json"


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
