"""A design as text, proposals with their reasons, predictions, claims, notes; and as a figure."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...base.sentences import WIDTH, unit_at_axis, with_standard_error, wrap
from ...base.units import unit_of
from ..figures.graph import draw_interval
from ..figures.style import CASES, TWO_COLUMNS, plt
from ..frequency.impedance import keep_scale
from ..registry import shows
from .headline import headline

if TYPE_CHECKING:
    import matplotlib.figure
    from matplotlib.axes import Axes

    from ...design import Design, ProposedController, TunedControllers
    from ...design.prediction import FeltImpedance


#: every tenth speed of the residual friction is printed: half a decade apart
SHOWN = 10


@shows("text")
def design_text(design: Design) -> str:
    """The whole design as text of at most `WIDTH` columns."""
    parts = [
        headline(design),
        [f'Design for "{design.experiment}", {design.place}', *_friction(design)],
        _assumptions(design),
        _proposals(design),
        _predictions(design),
        _list_felt(design.impedance, unit_of("stiffness", design.body.axis)),
        _residuals(design),
        _passivity(design),
    ]
    if design.notes:
        parts.append(["to be read with care", *(f"- {n}" for n in design.notes)])
    return "\n\n".join("\n".join(_wrap(line) for line in part) for part in parts)


def _wrap(line: str) -> str:
    if len(line) <= WIDTH:
        return line
    indent = " " * (len(line) - len(line.lstrip()) + 2)
    return wrap(line, rest=indent)


def _friction(design: Design) -> list[str]:
    f, unit = design.friction, unit_of("force", design.body.axis)
    if f is None:
        return ["  no friction level in the model"]
    known = design.body.parameters.get("coulomb.level")
    level = "  "
    if known is not None:
        level += f"Coulomb level {with_standard_error(known.value, known.stderr)} {unit}; "
    lines = [
        f"{level}over the identified shape {f.lowest.estimate:.4g} to {f.highest.estimate:.4g} "
        f"{unit}; within {design.assumptions.errors:g} standard errors {f.lowest.low:.4g} to "
        f"{f.highest.high:.4g} {unit}"
    ]
    if f.presliding is not None:
        stiff = unit_of("stiffness", design.body.axis)
        lines.append(
            f"  presliding stiffness {f.presliding.estimate:.4g} {stiff}, at least "
            f"{f.presliding.low:.4g} {stiff}"
        )
    return lines


def _assumptions(design: Design) -> list[str]:
    a, axis = design.assumptions, design.body.axis
    assert a.sample_period is not None and a.delay is not None
    return [
        f"assumed: load {a.load:.3g} {unit_of('inertia', axis)}, sample period "
        f"{1e3 * a.sample_period:.3g} ms, computing delay {1e3 * a.delay:.3g} ms, velocity filter "
        f"{a.velocity_bandwidth:.3g} Hz, encoder step {design.reach.step:.3g} "
        f"{unit_of('position', axis)}"
    ]


def _proposals(design: Design) -> list[str]:
    lines = ["proposed"]
    if design.cancellation is None:
        lines.append("  C: none")
    else:
        lines.append(f"  C: {design.cancellation.words}")
        by_why: dict[str, list[str]] = {}
        for r in design.cancellation.reasons:
            by_why.setdefault(r.why, []).append(str(r).removesuffix(f": {r.why}"))
        lines += [f"    {', '.join(numbers)}: {why}" for why, numbers in by_why.items()]
    if design.other is not None:
        unit = unit_of("force", design.body.axis)
        left = design.prediction.cases["hybrid"].simulated
        lines.append(
            f"    rather than {design.other.words}, with which the hybrid leaves "
            f"{design.other_left:.3g} {unit} rms, not {left:.3g}"
        )
    needs = "" if design.reach.measures_force else ", once there is a force sensor"
    lines.append(f"  H: low-pass with a gain k b/(b + abs(v)) before it{needs}")
    lines += [f"    {r}" for r in design.force_feedback.reasons]
    lines.append(f"    {_loop(design)}")
    return lines


def _loop(design: Design) -> str:
    loop = design.loop
    if math.isinf(loop.phase_margin):
        return f"loop gain {loop.gain:.3g} never reaches 1: stable with any delay"
    held = design.held
    return (
        f"loop gain {loop.gain:.3g} at rest, crossing 1 at {loop.crossover / (2 * math.pi):.3g} Hz "
        f"with a phase margin of {loop.phase_margin:.0f} deg; tolerates "
        f"{1e3 * loop.largest_delay:.3g} ms. "
        f"Held rigidly: {held.phase_margin:.0f} deg, {1e3 * held.largest_delay:.3g} ms"
    )


def _predictions(design: Design) -> list[str]:
    p, axis = design.prediction, design.body.axis
    unit, m = unit_of("force", axis), design.prediction.motion
    lines = [
        f"force error, {m.amplitude:.3g} {unit_of('position', axis)} at {m.frequency:.3g} Hz about "
        f"{m.centre:.3g} {unit_of('position', axis)} (up to {m.peak_speed:.3g} "
        f"{unit_of('velocity', axis)}), rms about the mean, {unit}",
        f"  {'':<8}{'linear':>10}{'slow motion':>14}{'simulated':>12}{'at peak speed':>16}",
    ]
    for case, c in p.cases.items():
        lines.append(
            f"  {case:<8}{c.linear:>10.3g}{c.quasi_static:>14.3g}{c.simulated:>12.3g}"
            f"{c.at_peak_speed:>16.3g}"
        )
    return lines


def _list_felt(felt: FeltImpedance, unit: str) -> list[str]:
    """Zhat_M of the cases by frequency: magnitude and phase, predicted ones in brackets."""
    impedance = felt.simulated or felt.predicted
    head = f"felt impedance at that peak speed, dB re 1 {unit} and deg: simulated (describing "
    rows = [f"{head}functions)"]
    if impedance is None:
        return rows + [f"  none: {why}" for why in felt.missing]
    frequency = impedance.data["frequency"].values
    rows.append(f"  {'at Hz':<8}" + "".join(f"{f:>22.3g}" for f in frequency))
    for case in map(str, impedance.data["case"].values):
        cells = (_felt_cell(felt, case, i) for i in range(len(frequency)))
        rows.append(f"  {case:<8}" + "".join(f"{cell:>22}" for cell in cells))
    if felt.predicted is not None and (band := felt.predicted.band) is not None:
        rows.append(
            f"  describing functions within {band.decibel.max():.2g} dB and "
            f"{band.degrees.max():.2g} deg: 95 % of the estimates"
        )
    return rows + [f"  without {why}" for why in felt.missing]


def _felt_cell(felt: FeltImpedance, case: str, i: int) -> str:
    texts = [
        f"{float(m.decibel.sel(case=case)[i]):.1f}/{float(m.phase.sel(case=case)[i]):.0f}"
        for m in (felt.simulated, felt.predicted)
        if m is not None
    ]
    return texts[0] if len(texts) == 1 else f"{texts[0]} ({texts[1]})"


def _residuals(design: Design) -> list[str]:
    """Residual friction of the four cases in slow motion, at some speeds."""
    unit, speed = unit_of("force", design.body.axis), unit_of("velocity", design.body.axis)
    residual = design.residual
    head = "".join(f"{v:>11.3g}" for v in residual.speeds[::SHOWN])
    lines = [f"friction left in slow steady motion, {unit}", f"  at {speed:<6}{head}"]
    for case, row in residual.rows.items():
        lines.append(f"  {case:<9}" + "".join(f"{x:>11.3g}" for x in row[::SHOWN]))
    return lines


def _passivity(design: Design) -> list[str]:
    lines = ["passivity"]
    for case, claims in design.claims.items():
        for claim in claims:
            lines.append(f"  {case}: {claim.heading}: {claim.statement} ({claim.verdict})")
    return lines


@shows("text")
def controller_text(proposed: ProposedController) -> str:
    """The laws, and the reason for each number."""
    names = ", ".join(stage.law.name for stage in proposed.controller.stages)
    return "\n".join([names, *(f"  {r}" for r in proposed.reasons)])


@shows("text")
def tuned_text(tuned: TunedControllers) -> str:
    """The force error before and after, and the numbers."""
    names = dict(tuned.cancellation.names()) if tuned.cancellation else {}
    names |= tuned.force_feedback.names()
    numbers = ", ".join(f"{n} = {v:.4g}" for n, v in names.items())
    return (
        f"Tuned by {tuned.simulations} simulations: force error {tuned.before:.4g} -> "
        f"{tuned.after:.4g} rms\n  {numbers}\n"
        f"  at a bound: {', '.join(tuned.at_bound) or 'none'}"
    )


@shows("figure")
def plot_design(design: Design) -> matplotlib.figure.Figure:
    """Three panels that compare the designed cases with no compensation, a line for each case."""
    figure, axes = plt.subplots(1, 3, figsize=(TWO_COLUMNS, 2.7))
    _force_error(axes[0], design)
    _residual(axes[1], design)
    _transparency(axes[2], design)
    for letter, title, axis in zip(
        "abc",
        ("simulated motion", "slow steady motion", "linear theory, with load"),
        axes,
        strict=True,
    ):
        axis.set_title(f"({letter}) {title}", loc="left", pad=4)
    handles, labels = axes[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=4)
    return figure


def _force_error(axis: Axes, design: Design) -> None:
    data = design.prediction.curves.data
    axis.axhline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    axis.axvline(0.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    for case in map(str, data["case"].values):
        colour, line, _ = CASES[case]
        one = data.sel(case=case)
        axis.plot(one["velocity"].values, one["force"].values, color=colour, linestyle=line, lw=0.8)
    force, speed = (unit_at_axis(data[n].attrs["units"]) for n in ("force", "velocity"))
    axis.set_xlabel(f"velocity ({speed})")
    axis.set_ylabel(rf"force error $R_D - R_M$ ({force})")


def _residual(axis: Axes, design: Design) -> None:
    unit = unit_at_axis(unit_of("force", design.body.axis))
    for case, row in design.residual.rows.items():
        colour, line, label = CASES[case]
        axis.semilogx(design.residual.speeds, row, color=colour, linestyle=line, label=label)
    axis.set_ylim(bottom=min(0.0, *(float(r.min()) for r in design.residual.rows.values())))
    axis.set_xlabel(f"speed ({unit_at_axis(unit_of('velocity', design.body.axis))})")
    axis.set_ylabel(f"friction left ({unit})")
    axis.grid(True)


def _transparency(axis: Axes, design: Design) -> None:
    response = design.transparency
    for k, (case, size) in enumerate(zip(response.cases, response.magnitude, strict=True)):
        colour, line, _ = CASES[case]
        axis.semilogx(response.frequency, size, color=colour, linestyle=line)
        if response.band is not None:
            ratio = 10 ** (response.band.decibel[k] / 20)
            draw_interval(axis, response.frequency, (size / ratio, size * ratio), colour)
    keep_scale(axis)
    axis.axhline(1.0, color="#BFBFBF", linewidth=0.5, zorder=0)
    axis.set_ylim(bottom=0.0)
    axis.set_xlim(float(response.frequency[0]), float(response.frequency[-1]))
    axis.set_xlabel("frequency (Hz)")
    axis.set_ylabel(r"$|R_M/R_D|$ (1)")
    axis.grid(True)
