"""The proposed motion in words, as findings and as a figure, which computes nothing."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

from ..base.finding import Finding, Graph, Series
from ..base.sentences import percent
from ..base.units import si_factor
from ..diagnose.noise_floor import say_floors
from ..next_experiment.prediction import DECIDES, SAME
from .figures.graph import draw_graph
from .figures.style import AFTER, BEFORE, MEASURED, plt
from .registry import shows

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from ..next_experiment import ArmPaths, Proposal, SimulatedDiagnosis
    from ..next_experiment.remedies import Remedy

#: most pairs of rival models that a sentence names one by one; more are summarised
FEW = 2


@shows("sentence")
def sentence_of(proposal: Proposal) -> str:
    """The motion and its expected result."""
    return " ".join(_sentences(proposal))


def _sentences(proposal: Proposal) -> Iterator[str]:
    if not proposal.rivals:
        yield _explain_nothing_open(proposal)
        return
    if proposal.reference is None:
        yield "All candidate motions exceed the limits, so no motion is proposed."
        return
    decided = [p for p in proposal.pairs if proposal.decides(p)]
    if proposal.is_useful:
        yield _describe_motion(proposal)
    if len(decided) > FEW:
        yield _describe_count(proposal, decided)
    else:
        yield from (_describe_gain(proposal, p) for p in decided)
    yield from (_describe_rest(proposal, p) for p in proposal.pairs if p not in decided)
    if proposal.diagnosis.more_is_missing:
        yield (
            "None of these models explains the present records: an error of "
            f"{say_floors(proposal.diagnosis.left)} noise floors remains, so the true effect may "
            "be none of them."
        )


def _explain_nothing_open(proposal: Proposal) -> str:
    if (curve := proposal.diagnosis.no_named_law) is not None:
        words = str(curve)
        return f"{words[0].upper()}{words[1:]}. No motion is proposed: a curve has no rival."
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
    both = [s for p in decided for s in proposal.both(p)]
    return (
        f"This motion distinguishes {len(decided)} of {len(proposal.pairs)} pairs of "
        "rivals: the wrong effect "
        f"of each pair then leaves {min(s.predicted for s in both):.1f} to "
        f"{max(s.predicted for s in both):.1f} noise floors beyond sensor noise (now "
        f"{min(s.present for s in both):.2f} to {max(s.present for s in both):.2f})."
    )


def _describe_gain(proposal: Proposal, pair: tuple[int, int]) -> str:
    first, second = proposal.both(pair)
    return (
        f"If {first.truth} is right, {first.other} then leaves {first.predicted:.1f} noise floors "
        f"beyond sensor noise (now {first.present:.2f}). If {second.truth} is right, "
        f"{second.other} then leaves {second.predicted:.1f} (now {second.present:.2f})."
    )


def _describe_rest(proposal: Proposal, pair: tuple[int, int]) -> str:
    a, b = (proposal.rivals[i] for i in pair)
    most = min(s.predicted for s in proposal.both(pair))
    sentence = (
        f"No candidate motion within the limits distinguishes {a} from {b}: the separation is "
        f"{most:.2f} noise floors, and {min(s.present for s in proposal.both(pair)):.2f} "
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


@shows("text")
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
            f"  {d.name} becomes determinable: standard error {percent(d.before, '.2g')} -> "
            f"{percent(d.after, '.2g')} of {d.value:.3g} {d.unit}"
        )
    return "\n".join(lines)


@shows("findings")
def proposal_findings(proposal: Proposal) -> tuple[Finding, ...]:
    """The proposal as findings: the motion, the separations, and parameters to be determined."""
    if not proposal.rivals:
        return (Finding("next experiment", "fine", proposal.sentence),)
    return tuple(_findings(proposal))


def _findings(proposal: Proposal) -> Iterator[Finding]:
    reference = proposal.reference
    numbers = {} if reference is None else {"duration": reference.duration}
    graph = _reference_graph(proposal)
    yield Finding("next experiment", "note", proposal.sentence, numbers, graph=graph)
    for pair in proposal.pairs:
        both = proposal.both(pair)
        if not both:
            continue
        decides = proposal.decides(pair)
        text = _describe_gain(proposal, pair) if decides else _describe_rest(proposal, pair)
        numbers = {f"present {i}": s.present for i, s in enumerate(both)}
        numbers |= {f"predicted {i}": s.predicted for i, s in enumerate(both)}
        yield Finding("separation of rivals", "note" if decides else "warning", text, numbers)
    for d in proposal.determined:
        text = (
            f"{d.name} becomes determinable: standard error {percent(d.after, '.2g')} of its value."
        )
        numbers = {"before": d.before, "after": d.after}
        yield Finding("determinable parameters", "note", text, numbers)


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


@shows("text")
def simulated_text(simulated: SimulatedDiagnosis) -> str:
    """What the diagnosis of simulated records states."""
    diagnosis = simulated.diagnosis
    what = ", ".join(str(c) for c in diagnosis.missing) or diagnosis.verdict
    return f"if {simulated.truth} is the true effect, the diagnosis states: {what}"


@shows("text")
def paths_text(paths: ArmPaths) -> str:
    """How well the paths determine the parameters, beside the records."""
    best = sorted(paths.errors, key=lambda name: paths.errors[name])[:3]
    gained = ", ".join(f"{name} (x {paths.errors[name]:.2g})" for name in best)
    text = (
        f"paths of {len(paths.reference.position)} joints, period {paths.period:g} s; standard "
        f"errors for as many samples as in the records: x {paths.gain:.2g} (mean), x "
        f"{max(paths.errors.values()):.2g} at most; condition number of the regressor "
        f"{paths.condition:.3g}, of the records {paths.recorded:.3g}"
    )
    if paths.is_useful:
        return f"{text}; largest gains: {gained}"
    return f"no path is better than the present records: {text}"


@shows("figure")
def plot_proposal(proposal: Proposal) -> Figure:
    """The proposed motion, the force that a wrong model would leave, and the separation of rivals.

    If no motion is proposed, the figure shows only the sentence of the proposal.
    """
    if proposal.reference is None:
        figure, ax = plt.subplots(figsize=(7.16, 1.2))
        ax.text(0.0, 0.5, proposal.sentence, wrap=True, va="center")
        ax.set_axis_off()
        return figure
    figure, axes = plt.subplots(
        3,
        1,
        figsize=(7.16, 4.2 + 0.34 * len(proposal.separations)),
        height_ratios=(1.6, 1.6, 0.4 + 0.34 * len(proposal.separations)),
    )
    graphs = [f.graph for f in proposal.findings() if f.graph is not None]
    draw_graph(graphs[0], axes[0])
    _plot_separation(axes[1], proposal)
    _separations(axes[2], proposal)
    return figure


def _plot_separation(ax: Axes, proposal: Proposal) -> None:
    """Force left for the best separated pair: of the wrong model and of the right model."""
    widest = max(proposal.separations, key=lambda s: s.predicted)
    curves = proposal.curves[proposal.separations.index(widest)]
    ax.plot(curves.time, curves.left, lw=0.8, color=BEFORE, label=f"{widest.other} (wrong)")
    ax.plot(curves.time, curves.noise, lw=0.8, color=MEASURED, label=f"{widest.truth} (right)")
    ax.set(xlabel="time (s)", ylabel=f"force left ({curves.unit})")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)


def _separations(ax: Axes, proposal: Proposal) -> None:
    rows = range(len(proposal.separations))
    ax.barh(
        [i - 0.18 for i in rows],
        [s.predicted for s in proposal.separations],
        height=0.34,
        color=BEFORE,
        label="with the proposed records (predicted)",
    )
    ax.barh(
        [i + 0.18 for i in rows],
        [s.present for s in proposal.separations],
        height=0.34,
        color=AFTER,
        label="on the present records",
    )
    ax.axvline(1.0, color="k", lw=0.6, ls="--")
    ax.set_yticks(rows, [f"{s.other}\nif {s.truth} is right" for s in proposal.separations])
    ax.invert_yaxis()
    ax.set_xscale("symlog", linthresh=1.0)
    ax.set_xlim(left=0.0)
    ax.set_xlabel("separation (noise floors)")
    ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.1, ncols=2)
