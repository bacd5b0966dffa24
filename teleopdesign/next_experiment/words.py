"""The proposal in words, as data, and as findings."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..base.finding import Finding, Graph, Series
from ..base.plain_data import make_plain
from ..base.quantity import si_factor
from ..diagnose.noise_floor import say_floors
from .prediction import DECIDES, SAME
from .rivals import pairs

if TYPE_CHECKING:
    from .prediction import Separation
    from .proposal import Proposal
    from .remedies import Remedy

#: most pairs of rival models that a sentence names one by one; more are summarised
FEW = 2


def sentence_of(proposal: Proposal) -> Proposal:
    """The proposal with its sentence."""
    return replace(proposal, sentence=" ".join(_sentences(proposal)))


def _sentences(proposal: Proposal) -> list[str]:
    if not proposal.rivals:
        return [_explain_nothing_open(proposal)]
    if proposal.reference is None:
        return ["All candidate motions exceed the limits, so no motion is proposed."]
    sentences = []
    pairs = list_pairs_once(proposal)
    decided = [p for p in pairs if proposal.decides(p)]
    left_open = [p for p in pairs if not proposal.decides(p)]
    if proposal.is_useful:
        sentences.append(_describe_motion(proposal))
    if len(decided) > FEW:
        sentences.append(_describe_count(proposal, decided))
    else:
        sentences += [_describe_gain(proposal, p) for p in decided]
    sentences += [_describe_rest(proposal, p) for p in left_open]
    if proposal.diagnosis.more_is_missing:
        sentences.append(
            "None of these models explains the present records: an error of "
            f"{say_floors(proposal.diagnosis.left)} noise floors remains, so the true effect may "
            "be none of them."
        )
    return sentences


def _explain_nothing_open(proposal: Proposal) -> str:
    if proposal.diagnosis.verdict == "undecided":
        return (
            "No candidate effect lowers the error: there are no rivals to distinguish, and no "
            "motion is proposed."
        )
    questions = proposal.diagnosis.questions
    nearest = [q.others[0].candidate for q in questions if q.added is None]
    if nearest:
        return (
            f"More is missing, and only {nearest[0]} comes near: there is no rival to distinguish "
            "it from. Longer check records decide whether this effect is present."
        )
    return "The present records decide: no rival is left to distinguish."


def list_pairs_once(proposal: Proposal) -> list[tuple[int, int]]:
    """Pairs of rivals of one question, each once."""
    return [(i, j) for i, j in pairs(proposal.rivals) if i < j]


def select_pair(proposal: Proposal, pair: tuple[int, int]) -> list[Separation]:
    """Both separations of a pair of rivals."""
    ids = {id(proposal.rivals[i]) for i in pair}
    return [s for s in proposal.separations if {id(s.truth), id(s.other)} == ids]


def _describe_motion(proposal: Proposal) -> str:
    reference = proposal.reference
    assert reference is not None
    all_bodies = " and the ".join(reference.position)
    times = {1: "", 2: ", and all of this twice"}.get(
        reference.repeats, f", and all of this {reference.repeats} times"
    )
    return (
        f"Let the {all_bodies} follow the reference ({reference.duration:.1f} s) twice, with no "
        f"hand and no contact: one record to fit, one to check. The {all_bodies} will "
        f"{', then '.join(reference.parts)}{times}."
    )


def _describe_count(proposal: Proposal, decided: Sequence[tuple[int, int]]) -> str:
    both = [s for p in decided for s in select_pair(proposal, p)]
    return (
        f"This motion distinguishes {len(decided)} of {len(list_pairs_once(proposal))} pairs of "
        "rivals: the wrong effect "
        f"of each pair then leaves {min(s.predicted for s in both):.1f} to "
        f"{max(s.predicted for s in both):.1f} noise floors beyond sensor noise (now "
        f"{min(s.present for s in both):.2f} to {max(s.present for s in both):.2f})."
    )


def _describe_gain(proposal: Proposal, pair: tuple[int, int]) -> str:
    first, second = select_pair(proposal, pair)
    return (
        f"If {first.truth} is right, {first.other} then leaves {first.predicted:.1f} noise floors "
        f"beyond sensor noise (now {first.present:.2f}). If {second.truth} is right, "
        f"{second.other} then leaves {second.predicted:.1f} (now {second.present:.2f})."
    )


def _describe_rest(proposal: Proposal, pair: tuple[int, int]) -> str:
    a, b = (proposal.rivals[i] for i in pair)
    most = min(s.predicted for s in select_pair(proposal, pair))
    sentence = (
        f"No candidate motion within the limits distinguishes {a} from {b}: the separation is "
        f"{most:.2f} noise floors, and {min(s.present for s in select_pair(proposal, pair)):.2f} "
        "on the present records, where 1 is clear."
    )
    remedies = proposal.remedies.get(pair, ())
    if not remedies:
        return sentence
    return f"{sentence} {_describe_remedies(remedies)}"


#: most remedies in a sentence, so that it stays readable
MOST_REMEDIES = 3


def _describe_remedies(remedies: Sequence[Remedy]) -> str:
    helping = [r for r in remedies if r.separation >= DECIDES]
    if helping:
        listed = "; or ".join(f"{r.change} ({r.separation:.1f})" for r in helping[:MOST_REMEDIES])
        more = len(helping) - MOST_REMEDIES
        others = f"; or in {more} other ways (`Proposal.remedies`)" if more > 0 else ""
        return f"In simulation, the true effect would be identified if {listed}{others}."
    changes = "; ".join(f"{r.change} ({r.separation:.2f})" for r in remedies)
    if all(r.separation < SAME for r in remedies):
        return (
            f"None of these changes helps: {changes}. With each of them both effects need the same "
            "force, and only knowledge of the device can say which effect is there."
        )
    return f"None of these changes is sufficient: {changes}."


def proposal_text(proposal: Proposal) -> str:
    """The proposal as text: sentence, table of separations, parameters that become determinable."""
    lines = ["next experiment: " + proposal.sentence]
    if proposal.separations:
        names = [str(name) for s in proposal.separations for name in (s.truth, s.other)]
        wide = max(36, *(len(name) + 2 for name in names))
        head = f"{'if this is right':<{wide}}{'this leaves':<{wide}}{'now':>7}{'then':>8}"
        lines += ["", f"{head}  noise floors"]
        for s in proposal.separations:
            lines.append(
                f"{s.truth!s:<{wide}}{s.other!s:<{wide}}{s.present:>7.2f}{s.predicted:>8.2f}"
            )
    for d in proposal.determined:
        lines.append(
            f"  {d.name} becomes determinable: standard error {_percent(d.before)} -> "
            f"{_percent(d.after)} of {d.value:.3g} {d.unit}"
        )
    return "\n".join(lines)


def _percent(part: float) -> str:
    return f"{100 * part:.2g} %" if np.isfinite(part) else "unknown"


def proposal_data(proposal: Proposal) -> dict[str, Any]:
    """The proposal as plain data (SI) for a JSON file.

    Separations in noise floors (1: a right model's error); times in s, bodies by name.
    """
    reference = proposal.reference
    data = {
        "verdict": proposal.diagnosis.verdict,
        "sentence": proposal.sentence,
        "rivals": [_place(r) for r in proposal.rivals],
        "reference": None
        if reference is None
        else {
            "duration": reference.duration,
            "parts": list(reference.parts),
            "repeats": reference.repeats,
        },
        "separations": [
            {
                "truth": _place(s.truth),
                "other": _place(s.other),
                "present": s.present,
                "predicted": s.predicted,
                "score": s.score,
            }
            for s in proposal.separations
        ],
        "determined": [asdict(d) for d in proposal.determined],
        "remedies": [
            {
                "rivals": [_place(proposal.rivals[i]) for i in pair],
                "tried": [asdict(r) for r in value],
            }
            for pair, value in proposal.remedies.items()
        ],
        "limits": {b: asdict(value) for b, value in proposal.limits.items()},
    }
    content: dict[str, Any] = make_plain(data)
    return content


def _place(rival: Any) -> dict[str, str]:
    return {"effect": rival.candidate.effect.name, "at": rival.candidate.at}


def proposal_findings(proposal: Proposal) -> tuple[Finding, ...]:
    """The proposal as findings: the motion, the separations, and parameters to be determined."""
    if not proposal.rivals:
        return (Finding("next experiment", "fine", proposal.sentence),)
    findings = [
        Finding(
            "next experiment",
            "note",
            proposal.sentence,
            {} if proposal.reference is None else {"duration": proposal.reference.duration},
            graph=_reference_graph(proposal),
        )
    ]
    for pair in list_pairs_once(proposal):
        both = select_pair(proposal, pair)
        if not both:
            continue
        decides = proposal.decides(pair)
        text = _describe_gain(proposal, pair) if decides else _describe_rest(proposal, pair)
        numbers = {f"present {i}": s.present for i, s in enumerate(both)}
        numbers |= {f"predicted {i}": s.predicted for i, s in enumerate(both)}
        findings.append(
            Finding("separation of rivals", "note" if decides else "warning", text, numbers)
        )
    for d in proposal.determined:
        text = f"{d.name} becomes determinable: standard error {_percent(d.after)} of its value."
        findings.append(
            Finding("determinable parameters", "note", text, {"before": d.before, "after": d.after})
        )
    return tuple(findings)


def _reference_graph(proposal: Proposal) -> Graph | None:
    reference, experiment = proposal.reference, proposal.diagnosis.experiment
    if reference is None:
        return None
    body = next(iter(reference.position))
    unit = experiment.channels[f"{body}.position"].unit
    series = []
    for name, position in reference.position.items():
        file_unit = experiment.channels[f"{name}.position"].unit
        factor = si_factor(file_unit, quantity="position", axis=experiment.axis(name))
        series.append(Series(name, reference.time, position / factor, "model"))
    return Graph("time (s)", f"position reference ({unit})", tuple(series))
