"""What `teleopdesign diagnose` prints first."""

import pytest

from teleopdesign.cli import main


@pytest.mark.parametrize(
    ("only", "verdict"),
    [
        ("stribeck", "effects_missing"),
        # looks for a curve in place of a law
        pytest.param("bias", "undecided", marks=pytest.mark.slow),
    ],
)
def test_the_verdict_stands_first_and_the_screen_has_twelve_lines(short_rod, capsys, only, verdict):
    assert main(["diagnose", str(short_rod), "--only", only]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith(f"verdict: {verdict}")
    assert len(lines) <= 12 and max(len(line) for line in lines[:-1]) <= 100
    assert any("fit error" in line for line in lines)
    assert any(line.startswith("noise floor") for line in lines)
    assert ("stribeck_velocity = " in "\n".join(lines)) == (only == "stribeck")


def test_how_the_log_was_read_and_the_model_stand_in_the_long_text(diagnosed):
    _, text = diagnosed
    assert "Record fit.csv.gz" in text and "device.inertia = " in text
    assert text.index("fit error") < text.index("verdict: effects_missing: stribeck at device")
