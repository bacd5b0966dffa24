"""Parameters that records do not determine are named, and doubtful effects leave the model."""

from dataclasses import replace

from teleopdesign.diagnose.answer import answer, load_answer, write_answer
from teleopdesign.diagnose.candidates import Candidate
from teleopdesign.diagnose.statements import SetAside, Undetermined
from teleopdesign.effects import EFFECTS
from teleopdesign.show.diagnose.text import ladder_text


def stribeck_of(end):
    return next(r.added for r in end.rungs if r.added is not None)


def test_what_was_set_aside_or_is_undetermined_stands_in_text_and_answer(
    diagnosis, experiment, tmp_path
):
    added, gone = stribeck_of(diagnosis), Candidate(EFFECTS["backlash"], "device")
    whole = replace(
        diagnosis,
        undetermined=(Undetermined(added, "the level at rest is not told"),),
        set_aside=(SetAside(gone, 0.03, "gap = 0.1 +- 0.2 m is not told from absence"),),
    )
    text = ladder_text(whole)
    assert "not determined: the level at rest" in text
    assert "set aside: backlash at device (3.00 %): gap" in text
    content = answer(whole)
    assert content["cannot_tell"][0]["effect"] == "stribeck"
    assert content["set_aside"][0]["reason"].startswith("gap")
    write_answer(whole, tmp_path / "answer.json")
    assert load_answer(tmp_path / "answer.json", experiment=experiment) == whole
