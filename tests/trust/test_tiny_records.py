"""Records of some hundred samples, whatever stands in them: diagnosed, or refused in one line.

FUZZ=5000 draws that many; what fails is kept: copy it to corpus_of_records/.
"""

import os
import random
import shutil
from pathlib import Path

import pytest
from clock import in_time
from trust.tiny_records import made

from teleopdesign.cli import main

DRAWN = int(os.environ.get("FUZZ", "10"))
SEED = os.environ.get("TELEOPDESIGN_SEED", "0")
KEPT = Path(os.environ.get("FUZZ_KEPT", "build/fuzz"))
CORPUS = Path(__file__).parent / "corpus_of_records"
SECONDS = 30  # of the processor, among few effects: such a diagnosis takes one or two

# a user's terminal shows warnings; they end nothing
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]


def diagnose(folder, random, capsys):
    """Run the command: a diagnosis, or one line about bad input."""
    options = ["--report", str(folder.parent / "page.html")] if random.random() < 0.1 else []
    options += ["--json", str(folder.parent / "answer.json")] if random.random() < 0.3 else []
    options += ["--quick"] if random.random() < 0.5 else []
    with in_time(SECONDS):
        status = main(["diagnose", str(folder), *options])
    printed = capsys.readouterr().err
    assert status in (0, 2), printed
    if status == 2:
        assert printed.splitlines()[-1].startswith("teleopdesign: "), printed


@pytest.mark.parametrize("number", range(DRAWN))
def test_a_tiny_record_is_diagnosed_or_refused_in_one_line(number, few, capsys, tmp_path):
    drawn = random.Random(f"{SEED} {number}")
    folder = tmp_path / "tiny"
    made(drawn, folder)
    try:
        diagnose(folder, drawn, capsys)
    except BaseException:
        shutil.copytree(folder, KEPT / f"tiny_{SEED}_{number}", dirs_exist_ok=True)
        raise


@pytest.mark.parametrize("name", sorted(p.name for p in CORPUS.iterdir()))
def test_a_record_that_once_ended_in_a_traceback_no_longer_does(name, few, capsys, tmp_path):
    folder = Path(shutil.copytree(CORPUS / name, tmp_path / "tiny"))
    assert main(["diagnose", str(folder), "--report", str(tmp_path / "page.html")]) in (0, 2), (
        capsys.readouterr().err
    )
