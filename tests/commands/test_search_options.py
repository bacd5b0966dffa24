"""What a user leaves out of a search, and what is shown while it runs."""

import io
import json

import pytest

from teleopdesign.cli import main
from teleopdesign.commands import _terminal
from teleopdesign.commands._progress import BETWEEN_LINES, Reporter
from teleopdesign.commands._terminal import PrintableStream, print_styled
from teleopdesign.diagnose.candidate_fits import ProgressLine
from teleopdesign.diagnose.search_plan import PLAN, QUICK


class Terminal(io.StringIO):
    encoding = "utf-8"

    def isatty(self):
        return True


def effects_in(path):
    return {c["effect"] for c in json.loads(path.read_text())["candidates"]}


@pytest.mark.slow
def test_only_the_named_effects_are_candidates_and_the_answer_says_so(rod, few, tmp_path, capsys):
    answer = tmp_path / "answer.json"
    command = ["diagnose", str(rod), "--only", "stribeck", "bias", "--json", str(answer)]
    assert main(command) == 0
    assert effects_in(answer) == {"stribeck", "bias"}
    note = "only these effects were candidates: bias, stribeck"
    assert json.loads(answer.read_text())["left_out"] == [note]
    assert f"left out: {note}" in capsys.readouterr().out


@pytest.mark.slow
def test_an_excluded_effect_is_no_candidate(rod, few, tmp_path):
    answer = tmp_path / "answer.json"
    command = ["diagnose", str(rod), "--exclude", "presliding", "--exclude", "spring"]
    assert main([*command, "--json", str(answer)]) == 0
    assert effects_in(answer) == {"stribeck", "bias"}


@pytest.mark.slow
def test_quick_says_what_it_leaves_out_in_text_answer_and_report(rod, few, tmp_path, capsys):
    answer, page = tmp_path / "answer.json", tmp_path / "report.html"
    command = ["diagnose", str(rod), "--quick", "--json", str(answer), "--report", str(page)]
    assert main(command) == 0
    out = capsys.readouterr().out
    for words in QUICK.omissions():
        assert words in " ".join(out.split())
        assert words in json.loads(answer.read_text())["left_out"]
    assert "No more than 2 effects were added; pairs" in page.read_text(encoding="utf-8")


def test_the_usual_plan_leaves_nothing_out():
    assert PLAN.omissions() == () and len(QUICK.omissions()) == 3


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["--only", "stribek"], '--only: no effect "stribek"; did you mean "stribeck"?'),
        (["--exclude", "coulom"], '--exclude: no effect "coulom"; did you mean "coulomb"?'),
        (["--only", "bias", "--exclude", "bias"], "--exclude: leaves no effect to try"),
    ],
)
def test_a_wrong_name_is_one_line_with_the_nearest_name(arguments, expected, rod, refused):
    assert expected in refused("diagnose", rod, *arguments)


def test_a_folder_behind_only_is_asked_to_stand_before_it(rod, refused):
    line = refused("diagnose", rod, "--only", "bias", rod)
    assert f'"{rod}" is a file or folder: put it before --only' in line


# progress


def lines_of(count, stage="step 1"):
    return [ProgressLine("bias", begun=k, total=count, stage=stage) for k in range(1, count + 1)]


def test_a_line_of_progress_tells_its_stage_and_count():
    assert lines_of(3)[1] == "step 1: bias (2 of 3)"
    assert ProgressLine("bias", begun=2, total=3).within("step 4") == "step 4: bias (2 of 3)"


def test_a_terminal_shows_the_time_left(monkeypatch):
    terminal, now = Terminal(), [0.0]
    monkeypatch.setattr("sys.stderr", terminal)
    report = Reporter(clock=lambda: now[0])
    for line in lines_of(11):
        report(line)
        now[0] += 2.0
    # ten of eleven are done after 20 s: one is left
    assert terminal.getvalue().endswith("step 1: bias (11 of 11), about 2 s left of step 1")
    assert "bias (2 of 11)," not in terminal.getvalue(), "two say little of the rest"
    assert "\n" not in terminal.getvalue()


def test_a_pipe_is_given_plain_lines_now_and_then(monkeypatch, capsys):
    now = [0.0]
    report = Reporter(clock=lambda: now[0])
    for line in lines_of(9):
        now[0] += 0.4 * BETWEEN_LINES
        report(line)
    lines = capsys.readouterr().err.splitlines()
    assert [line.split(",")[0] for line in lines] == [f"step 1: bias ({k} of 9)" for k in (3, 6, 9)]
    assert all(line.isprintable() for line in lines)


# colours


def styled(stream, monkeypatch):
    monkeypatch.setattr("sys.stdout", PrintableStream(stream))
    print_styled("plain\nverdict", lambda line: "good" if line == "verdict" else "")
    return stream.getvalue()


def test_a_terminal_is_given_colours(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    expected = f"plain\n\033[{_terminal.STYLES['good']}mverdict\033[0m\n"
    assert styled(Terminal(), monkeypatch) == expected


@pytest.mark.parametrize(("variable", "value"), [("NO_COLOR", "1"), ("TERM", "dumb")])
def test_colours_can_be_switched_off(variable, value, monkeypatch):
    monkeypatch.setenv(variable, value)
    assert styled(Terminal(), monkeypatch) == "plain\nverdict\n"


def test_a_pipe_is_given_no_colours(monkeypatch):
    assert styled(io.StringIO(), monkeypatch) == "plain\nverdict\n"


def test_codes_in_a_text_do_not_reach_the_terminal_with_colours(monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("TERM", "xterm")
    terminal = Terminal()
    monkeypatch.setattr("sys.stdout", PrintableStream(terminal))
    print_styled("a\033[2Jb", lambda line: "bad")
    assert terminal.getvalue() == "\033[31ma\\x1b[2Jb\033[0m\n"
