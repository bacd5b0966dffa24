"""Widths that the records do not determine, such as that of a backlash.

The moments at which a tip crosses its gap depend on the whole motion before. So the sum of squares
has several minima over the width, and a standard error describes only one of them. Here the
parameter is fixed at other values, and the other parameters are fitted again.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from ..base.units import unit_after_number
from ..measurement.prepare import Prepared
from .candidates import Candidate
from .criteria import CRITERIA
from .effort import EFFORTS
from .evidence import whole_score
from .fit import Fit, estimate


def explain_open_width(fit: Fit, candidate: Candidate, prepared: Prepared) -> str:
    """A sentence on another value of an essential parameter that fits as well; "": none does.

    The parameter is held at a part and at a multiple of its value (`Criteria.times`). The other
    parameters are fitted again from their values.
    """
    for name, declared in candidate.effect.parameters.items():
        full = f"{candidate.at}.{candidate.effect.name}.{name}"
        if not declared.search.essential or full not in fit.free:
            continue
        best = fit.model.parameters[full]
        for other in (best.value / CRITERIA.times, best.value * CRITERIA.times):
            if not declared.lower <= other <= declared.upper:
                continue
            held = fit.model.with_values({full: replace(best, value=other, fixed=True)})
            again = estimate(held, prepared, effort=EFFORTS.rough)
            if whole_score(again, fit) < CRITERIA.close:
                unit = unit_after_number(fit.model.unit(full))
                return (
                    f"{name} = {other:.3g}{unit} fits as well as {best.value:.3g}{unit}: these "
                    "records do not determine it"
                )
    return ""


@dataclass(frozen=True)
class OpenWidths:
    """The sentences of `explain_open_width` on the fits of one ranking; each is computed once."""

    prepared: Prepared
    #: by the fit's identity, which holds while the fit stands beside it
    known: dict[int, tuple[Fit, str]] = field(default_factory=dict)

    def explain(self, fit: Fit, candidate: Candidate) -> str:
        """The sentence on a fit; "" where the records determine its essential parameters."""
        if not any(p.search.essential for p in candidate.effect.parameters.values()):
            return ""
        if id(fit) not in self.known:
            sentence = explain_open_width(fit, candidate, self.prepared)
            self.known[id(fit)] = (fit, sentence)
        return self.known[id(fit)][1]
