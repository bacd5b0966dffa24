"""How claims, maps of margins and energies of ports look."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..base.sentences import round_down, unit_at_axis, with_standard_error
from ..base.shown import html_table
from ..base.units import unit_after_number
from ..blocks import NINETY_FIVE
from .figures.style import GREY, ONE_COLUMN, THEORY, plt
from .registry import shows

if TYPE_CHECKING:
    import matplotlib.figure

    from ..passivity import Certificate, Claim, DiagramClaims, IntervalClaim, MarginMap, PortEnergy
    from ..passivity.claims.claim import Region

#: margins above this are drawn in the same colour: the sign counts, and large ones differ by
#: decades
_LARGEST = 2.0


@shows("text")
def claim_text(claim: Claim) -> str:
    """The status with the statement, and the verdict in words."""
    return f"{claim.heading}: {claim.statement}\n    {claim.verdict}"


@shows("table")
def claim_table(claim: Claim) -> str:
    """Statement, status and verdict."""
    rows = [("statement", claim.statement), ("status", claim.status), ("by", claim.verdict)]
    return html_table("Claim", ("", ""), rows)


@shows("text")
def certificate_text(certificate: Certificate) -> str:
    """Kind and title of a certificate."""
    return f"Certificate ({certificate.kind}): {certificate.content.get('title', '')}"


@shows("text")
def interval_claim_text(claim: IntervalClaim) -> str:
    """The status over the box, the worst point that was evaluated, and what is proved."""
    units = {n: unit_after_number(claim.units.get(n, "1")) for n in claim.worst}
    where = ", ".join(f"{n} = {v:.6g}{units[n]}" for n, v in claim.worst.items())
    lines = [f"{claim.known}: {claim.statement}", f"    {claim.how}"]
    unit = unit_after_number(claim.unit)
    if not np.isnan(claim.margin):
        lines.append(f"    worst margin {claim.margin:.4g}{unit} at {where or 'its values'}")
    if not np.isnan(claim.proved_margin):
        least = round_down(claim.proved_margin, digits=4)
        lines.append(f"    proved to be at least {least:g}{unit}")
    return "\n".join(lines)


@shows("table")
def interval_claim_table(claim: IntervalClaim) -> str:
    """The interval of each value, and its value at the worst point."""
    rows = [
        (n, f"{low:g}", f"{high:g}", f"{claim.worst[n]:.6g}", claim.units.get(n, ""))
        for n, (low, high) in claim.intervals.items()
    ]
    head = ("value", "from", "to", "at the worst point", "unit")
    note = f"{claim.statement}; margin {claim.margin:.4g} {claim.unit}. {claim.how}"
    return html_table(claim.known, head, rows, note=note)


@shows("text")
def diagram_claims_text(claims: DiagramClaims) -> str:
    """A line for each claim."""
    lines = [f"{s.heading:<9} {s.topic}: {s.claim.statement}" for s in claims.claims]
    return "\n".join([f"Claims on the {claims.diagram.name}", *lines])


@shows("table")
def diagram_claims_table(claims: DiagramClaims) -> str:
    """Status, topic, statement and verdict of each claim."""
    rows = [(s.heading, s.topic, s.claim.statement, s.claim.verdict) for s in claims.claims]
    head = ("status", "on", "statement", "by")
    return html_table(f"Claims on the {claims.diagram.name}", head, rows)


@shows("text")
def region_text(region: Region) -> str:
    """The number of points of each status."""
    counts = {s: int((region.status == s).sum()) for s in sorted(set(region.status.ravel()))}
    total = ", ".join(f"{n} {s}" for s, n in counts.items())
    return f"Region of {region.status.size} points: {total}"


@shows("text")
def margin_map_text(margins: MarginMap) -> str:
    """The number of points with a margin, and what is left out."""
    margin = margins.data["llewellyn"]
    (first, second), stable = margin.dims, int((margin >= 0).sum())
    gone = f"; left out: {', '.join(margins.left_out)}" if margins.left_out else ""
    return (
        f"Llewellyn's margin over {first} and {second}: not below 0 at {stable} of {margin.size} "
        f"points, checked numerically on the axis{gone}"
    )


@shows("figure")
def plot_margin_map(margins: MarginMap) -> matplotlib.figure.Figure:
    """Llewellyn's margin as colour over two parameters, with a black line at margin zero."""
    margin = margins.data["llewellyn"]
    first, second = map(str, margin.dims)
    x, y = (margins.data[n].values for n in (second, first))
    shown = np.clip(margin.values, -_LARGEST, _LARGEST)
    figure, axes = plt.subplots(figsize=(ONE_COLUMN, 0.8 * ONE_COLUMN))
    colours = axes.pcolormesh(x, y, shown, cmap="RdBu", vmin=-_LARGEST, vmax=_LARGEST)
    if shown.min() < 0 < shown.max():
        axes.contour(x, y, shown, levels=[0.0], colors="black")
    axes.set_xlabel(f"{second} ({unit_at_axis(margin[second].units)})")
    axes.set_ylabel(f"{first} ({unit_at_axis(margin[first].units)})")
    bar = figure.colorbar(colours, ax=axes)
    bar.set_label("least Llewellyn margin on the axis (1)")
    return figure


@shows("text")
def port_energy_text(observed: PortEnergy) -> str:
    """The energy in the end and at its least, and whether any was released."""
    final, error = (float(observed.data[n][-1]) for n in ("energy", "stderr"))
    verdict = "energy was released" if observed.certain else "no energy was certainly released"
    if observed.certain and observed.moves_at_start:
        verdict += ", or was in the motion, which did not begin at rest"
    when = 0.0 if abs(observed.when) < np.finfo(float).eps else observed.when
    return (
        f"Energy into the port: {with_standard_error(final, error)} J in the end, "
        f"least {observed.lowest:.4g} J at {when:.4g} s: {verdict}"
    )


@shows("figure")
def plot_port_energy(observed: PortEnergy) -> matplotlib.figure.Figure:
    """Energy (J) into a port over time, its 95 % band, and the spans in which energy comes out."""
    data = observed.data
    t, e, error = (data[n].values for n in ("time", "energy", "stderr"))
    figure, axis = plt.subplots(figsize=(ONE_COLUMN, 2.2))
    axis.axhline(0.0, color=GREY, linewidth=0.6)
    for k, (begin, end, _) in enumerate(observed.given_out()):
        label = "energy comes out" if k == 0 else None
        axis.axvspan(begin, end, color="#F6D5C0", linewidth=0, label=label)
    if error.max() > 0:
        axis.fill_between(
            t,
            e - NINETY_FIVE * error,
            e + NINETY_FIVE * error,
            color=THEORY,
            alpha=0.25,
            linewidth=0,
        )
    axis.plot(t, e, color=THEORY, label="energy into the port")
    axis.set_xlim(float(t[0]), float(t[-1]))
    axis.set_xlabel("time (s)")
    axis.set_ylabel("energy (J)")
    axis.legend(loc="best")
    return figure
