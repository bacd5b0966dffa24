"""The parts of the page as text, tables and figures of a workbench, which stays unchanged."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from ..base.errors import TeleopDesignError
from ..base.sentences import number_on_page as number
from ..base.sentences import unit_on_page as unit_text
from ..base.sentences import with_error_on_page as with_error
from ..base.units import unit_after_number, unit_of
from ..diagnose.by_simulation import compare_by_simulation
from ..diagnose.comparison import residual_data
from ..diagnose.evidence import floors_left, is_adequate
from ..diagnose.noise_floor import say_floors
from ..show.figures.carrier import carrier_of_change, with_carrier
from ..show.report.tables import correlation_rows
from .workbench import Workbench

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

    from ..design import Design
    from ..diagnose.rung import Rung
    from ..model import Model
    from ..show import Drawing
    from ..simulate import Simulation


def residuals(bench: Workbench, rung: int = -1) -> Dataset:
    """Forces of a rung's model along every measured motion; see `Comparison.data`."""
    return _residuals(_Key(bench, bench.rungs[rung].fit.model))


def rung_options(bench: Workbench) -> dict[str, int]:
    """The models of the ladder: name on the page -> number of the rung."""
    return {_name(rung): k for k, rung in enumerate(bench.rungs)}


def _name(rung: Rung) -> str:
    return "your model, re-estimated" if rung.added is None else f"+ {rung.added}"


def _name_of_error(bench: Workbench) -> str:
    """The name of the error on rows that were not fitted: of records, or of blocks in turn."""
    return "check error" if bench.search.whole.of("check") else "held-out error"


def ladder(bench: Workbench) -> str:
    """The errors of every rung as a Markdown table, with the noise floor."""
    lines = [f"| model | fit error | {_name_of_error(bench)} |", "|:---|---:|---:|"]
    for rung in bench.rungs:
        fit, check = (_percent(e) for e in (rung.fit.fit_error, rung.fit.check_error))
        lines.append(f"| {_name(rung)} | {fit} | {check} |")
    lines.append(f"| noise floor | | {_percent(bench.state.floor.value)} |")
    return "\n".join(lines)


def candidate_options(bench: Workbench) -> dict[str, tuple[str, str]]:
    """Candidates, best first: name on the page -> (effect, place)."""
    return {
        f"{r.candidate}: {_name_of_error(bench)} {_percent(r.fit.check_error)}"
        + (f" ({r.note})" if r.note else ""): r.candidate.key
        for r in bench.candidates
    }


def supported_option(bench: Workbench) -> str | None:
    """Name on the page of the best candidate that the records support; None: they support none."""
    supported = {r.candidate.key for r in bench.state.supported}
    names = (name for name, key in candidate_options(bench).items() if key in supported)
    return next(names, None)


def verdict(bench: Workbench) -> str:
    """What the ladder comes to, as Markdown, where no supported candidate is left; else ""."""
    if not bench.is_ranked or bench.state.supported:
        return ""
    state = bench.state
    left = say_floors(floors_left(state.fit, state.floor))
    if is_adequate(state.fit, state.floor):
        names = ", ".join(str(r.added) for r in bench.rungs if r.added is not None)
        what = f"with {names} the model is adequate" if names else "your model is adequate"
        return f"**Verdict: {what}.** What is left is noise ({left} noise floors)."
    return (
        f"**Verdict: undecided.** {left} noise floors are left, and the records support no further "
        "effect."
    )


def candidate_rows(bench: Workbench) -> list[dict[str, str]]:
    """The candidates for the last rung, as rows of a table."""
    supported = {r.candidate.key for r in bench.state.supported}
    return [
        {
            "effect": r.candidate.effect.name,
            "at": r.candidate.at,
            "fit error": _percent(r.fit.fit_error),
            _name_of_error(bench): _percent(r.fit.check_error),
            "supported": "yes" if r.candidate.key in supported else "no",
            "note": r.note,
        }
        for r in bench.candidates
    ]


def compare_rungs(bench: Workbench, one: int, other: int) -> str:
    """Errors and parameters of two rungs side by side, as a Markdown table."""
    first, second = bench.rungs[one].fit, bench.rungs[other].fit
    name = _name_of_error(bench)
    lines = [
        f"| | {_name(bench.rungs[one])} | {_name(bench.rungs[other])} |",
        "|:---|---:|---:|",
        f"| fit error | {_percent(first.fit_error)} | {_percent(second.fit_error)} |",
        f"| {name} | {_percent(first.check_error)} | {_percent(second.check_error)} |",
    ]
    names = dict.fromkeys([*first.model.parameters, *second.model.parameters])
    for name in names:
        cells = [_estimate(fit.model, name) for fit in (first, second)]
        lines.append(f"| `{name}` | {cells[0]} | {cells[1]} |")
    return "\n".join(lines)


def _estimate(model: Model, name: str) -> str:
    """A parameter with its standard error and unit; "-" if the model has no such parameter."""
    if name not in model.parameters:
        return "-"
    value = model.parameters[name]
    best, error = with_error(value.value, value.stderr)
    sure = f" ± {error}" if value.stderr == value.stderr else ""
    return f"{best}{sure} {unit_text(model.unit(name))}"


def correlations(bench: Workbench) -> str:
    """Correlations of the last model's estimates as a Markdown table; "" for fewer than two."""
    rows = correlation_rows(bench.state.fit)
    if len(rows) < 2:
        return ""
    numbers = [str(k + 1) for k in range(len(rows))]
    head = f"| correlation of the estimates | {' | '.join(numbers)} |"
    lines = [
        f"| {k} `{row['name']}` | {' | '.join(f'{r:.2f}' for r in row['values'])} |"
        for k, row in zip(numbers, rows, strict=True)
    ]
    return "\n".join([head, f"|:---|{'---:|' * len(rows)}", *lines])


def simulated_motion(bench: Workbench) -> Figure | str:
    """Motion of the last model under the recorded forces over the measured one; or why not."""
    try:
        return compare_by_simulation(bench.model, bench.experiment).plot()
    except TeleopDesignError as error:
        return str(error)


def carried_residuals(bench: Workbench, one: int, other: int, body: str) -> tuple[Dataset, Dataset]:
    """Residuals of two rungs, with the variable that carries what they differ by."""
    bodies = [bench.rungs[rung].fit.model.body(body) for rung in (one, other)]
    carrier = carrier_of_change(*bodies)
    data = [with_carrier(residuals(bench, k), carrier, bodies[0].axis) for k in (one, other)]
    return data[0], data[1]


def move_parameter(bench: Workbench, parameter: str, factor: float) -> str:
    """The errors with one parameter at `factor` times its value, as Markdown."""
    value = bench.model.parameters[parameter]
    unit = unit_text(bench.model.unit(parameter))
    there = bench.state.fit
    errors = there.fit_error, there.check_error
    if factor != 1.0:  # where nothing is moved nothing is computed: the page is drawn at once
        try:
            errors = bench.errors({parameter: factor * value.value})
        except TeleopDesignError as error:
            return str(error)
    rows = (
        ("fit", there.fit_error, errors[0]),
        ("check", there.check_error, errors[1]),
    )
    table = "\n".join(f"| {n} | {_percent(a)} | {_percent(b)} |" for n, a, b in rows)
    there_now = f"{number(factor * value.value)}{unit_after_number(unit)}"
    return (
        f"`{parameter}` = {there_now} (estimated: {_estimate(bench.model, parameter)})"
        f"\n\n| error | as estimated | as moved |\n|:---|---:|---:|\n{table}"
    )


def moved_residuals(bench: Workbench, parameter: str, factor: float) -> Dataset | None:
    """Forces of the last model with one parameter moved; None if the value is out of bounds."""
    if factor == 1.0:
        return residuals(bench)
    value = factor * bench.model.parameters[parameter].value
    try:
        return residual_data(bench.model.with_values({parameter: value}), bench.search.whole)
    except TeleopDesignError:
        return None


def what_is_left(bench: Workbench) -> Figure:
    """Views of the residual of the last model, with a sentence for each dependence."""
    from ..show.unexplained.findings import plot_unexplained
    from ..unexplained import describe_residual

    floor = bench.state.floor if bench.is_ranked else None
    return plot_unexplained(describe_residual(bench.state.fit, bench.search.whole, floor))


def next_experiment(bench: Workbench) -> str:
    """The next measurement that distinguishes what the records leave open, as text."""
    from ..next_experiment import propose

    return repr(propose(bench.diagnosis()))


def design_parts(bench: Workbench, body: str) -> list[tuple[str, str, Figure | Drawing | str]]:
    """A compensation for the body of the last model, one part for each tab of the page.

    returns: (title, caption, content); a single part with the reason if there is no design
    """
    from ..show import draw_diagram

    try:
        design = propose_design(bench, body)
        signals = "; ".join(f"`{name}` {text}" for name, text in design.diagram.texts.items())
        parts: list[tuple[str, str, Figure | Drawing | str]] = [
            ("Before and after", _BEFORE_AND_AFTER, design.plot()),
            ("Numbers, reasons and claims", "", repr(design)),
            ("Diagram", signals, draw_diagram(design.diagram)),
            ("Bode", _BODE, design.transparency.plot(columns=2)),
        ]
        felt = design.impedance
        if felt.simulated is not None:
            impedance = felt.simulated.plot("frequency", model=felt.predicted, columns=2)
            parts.append(("Impedance", _IMPEDANCE, impedance))
    except TeleopDesignError as error:
        return [("No design", "", str(error))]
    force = unit_text(unit_of("force", design.body.axis))
    push = f"The compensated device without a hand, pushed with {number(_push(design))} {force}."
    try:
        parts.append(("Simulation", push, _push_device(design).plot()))
    except TeleopDesignError as error:
        parts.append(("Simulation", push, str(error)))
    return parts


#: what the figures of a design show
_BEFORE_AND_AFTER = (
    "The force error in a simulated motion, the friction that is left in slow "
    "steady motion, and how well the wanted force arrives at a load."
)
_BODE = "From the wanted force to the force on a load, in linear theory: 0 dB is perfect."
_IMPEDANCE = (
    "Force that a hand feels over its motion. Points: simulated with sampling, delay and encoder. "
    "Lines: describing functions."
)


def propose_design(bench: Workbench, body: str) -> Design:
    """The compensation that `teleopdesign design` would propose for the last model."""
    return _designs(_Key(bench, bench.model), body)


def _push_device(design: Design) -> Simulation:
    """The designed device, pushed for a second with half of the largest recorded command."""
    from ..simulate import simulate

    push = {"R_D": _push(design)}
    return simulate(design.diagram, duration=1.0, inputs=push, computer=design.sampling)


def _push(design: Design) -> float:
    """Half of the largest recorded command."""
    return 0.5 * design.reach.command


class _Key:
    """A workbench compared by its model, for the cache; models of two steps are two objects."""

    def __init__(self, bench: Workbench, model: Model) -> None:
        self.bench, self.model = bench, model

    def __hash__(self) -> int:
        return id(self.model)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and other.model is self.model


@lru_cache(maxsize=4)
def _designs(key: _Key, body: str) -> Design:
    from ..design import design

    return design(key.bench.diagnosis(), place=body)


@lru_cache(maxsize=8)
def _residuals(key: _Key) -> Dataset:
    return residual_data(key.model, key.bench.search.whole)


def _percent(error: float) -> str:
    return f"{100 * error:.2f} %" if error == error else "-"
