"""The sentence on the candidate that comes nearest where none is supported."""

from types import SimpleNamespace

import pytest

from teleopdesign.diagnose import ladder_text


def diagnosis(*, left, groups=(), reason=""):
    """A diagnosis of 10 % whose best further candidate, a spring, would leave this part."""
    fit = SimpleNamespace(check_error=left)
    ranked = [SimpleNamespace(candidate="spring at device", fit=fit, counts=True, score=0.5)]
    aside = [SimpleNamespace(candidate="spring at device", reason=reason)] if reason else []
    return SimpleNamespace(
        open=None,
        possible=ranked,
        after=SimpleNamespace(check_error=0.1),
        set_aside=aside,
        groups=groups,
    )


@pytest.mark.parametrize(
    "diagnosed, sentence",
    [
        (diagnosis(left=0.05), "would leave 5 %: on these records this may be chance."),
        (diagnosis(left=0.05, reason="at a bound"), "would leave 5 %: at a bound."),
        (diagnosis(left=0.0999), ""),
        (diagnosis(left=0.05, groups=(("bias at device", "spring at device"),)), ""),
    ],
)
def test_it_is_named_where_it_helps_and_is_not_listed_before(diagnosed, sentence, monkeypatch):
    monkeypatch.setattr(ladder_text, "possible_next", lambda one: one.possible)
    text = ladder_text._nearest(diagnosed)
    assert text.endswith(sentence) and bool(text) == bool(sentence)
