"""The end of a ladder in the search: its rungs with their final errors, and what they leave."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..base.frozen import ByValue
from .adequacy import VerdictName, is_adequate
from .candidates import Candidate
from .fit import Fit
from .free_functions import Belief
from .ladder_state import LadderSearch
from .learnable import Learnable, NearReversals
from .no_named_law import FreeForm
from .noise_floor import NoiseFloor
from .ranking import Ranking
from .repeats import Repeatability
from .rung import Rung
from .statements import SetAside, Undetermined


@dataclass(frozen=True, eq=False)
class LadderEnd(ByValue):
    """What a search ends with; `result.diagnosis_of` states it as a `Diagnosis`.

    last: ranking after the last rung, none of which was accepted
    estimated: the last rung's fit, parameters not yet corrected for errors of the readings
    beliefs: accepted effect (name, place) -> what it explains beside free functions
    named: accepted effects that are probable enough to be called missing
    free_form: a curve without a named law that leaves less than the final model
    silence: why the records tell no effect; "": they may tell one
    The other fields are those of `Diagnosis`.
    """

    search: LadderSearch
    verdict: VerdictName
    rungs: tuple[Rung, ...]
    last: Ranking
    estimated: Fit
    floor: NoiseFloor
    learnable: Learnable | None = None
    near_reversals: NearReversals | None = None
    repeats: Repeatability | None = None
    undetermined: tuple[Undetermined, ...] = ()
    set_aside: tuple[SetAside, ...] = ()
    on_all_records: float | None = None
    named: tuple[Candidate, ...] = ()
    beliefs: Mapping[tuple[str, str], Belief] = field(default_factory=dict)
    silence: str = ""
    free_form: FreeForm | None = None

    @property
    def before(self) -> Fit:
        """The fit of the user's model, re-estimated."""
        return self.rungs[0].fit

    @property
    def after(self) -> Fit:
        """The fit of the model with every accepted effect."""
        return self.rungs[-1].fit

    def reason_set_aside(self, key: tuple[str, str]) -> str:
        """Why an effect (name, place) was accepted and removed again; "" for all other effects."""
        return next((one.reason for one in self.set_aside if one.candidate.key == key), "")

    @property
    def more_is_missing(self) -> bool:
        """Whether the final model leaves more than noise."""
        return not is_adequate(self.after, self.floor)
