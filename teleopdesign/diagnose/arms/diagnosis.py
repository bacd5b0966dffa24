"""What a recording says about an arm: a ladder of effects at its joints, and the verdict on it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...by_value import ByValue
from ...measurement.experiment import Experiment
from ..candidates import Candidate
from ..diagnosis import Diagnosis
from ..ladder_text import ladder_html, sentence
from ..ranking import named_instead
from .fit import ArmFit, error_over_joints
from .prepared import PreparedArm


@dataclass(frozen=True, eq=False)
class ArmRung(ByValue):
    """One step of an arm's ladder: what was added at which joint (None: the user's model), the fit.

    instead_of: the effect of the user's model that it takes the place of
    """

    added: Candidate | None
    fit: ArmFit
    instead_of: Candidate | None = None

    @property
    def said(self) -> str:
        """What was added, in words."""
        return "" if self.added is None else named_instead(self.added, self.instead_of)


@dataclass(frozen=True, eq=False)
class ArmDiagnosis(ByValue):
    """What a recording says about the model of an arm.

    verdict: "effects_missing", "model_adequate" or "undecided"
    rungs: the user's model re-estimated, then one rung an effect, over all joints
    joints: joint -> its diagnosis, beside what the others say of the links
    link_errors: (b,) standard errors of the base parameters
    """

    experiment: Experiment
    prepared: PreparedArm
    verdict: str
    rungs: tuple[ArmRung, ...]
    joints: Mapping[str, Diagnosis]
    link_errors: tuple[float, ...]

    @property
    def before(self) -> ArmFit:
        """The user's model, re-estimated."""
        return self.rungs[0].fit

    @property
    def after(self) -> ArmFit:
        """The model with every accepted effect."""
        return self.rungs[-1].fit

    @property
    def missing(self) -> tuple[Candidate, ...]:
        """Effects that can be named, in the order added."""
        named = {c.key for d in self.joints.values() for c in d.missing}
        return tuple(r.added for r in self.rungs if r.added is not None and r.added.key in named)

    @property
    def floor(self) -> float:
        """Noise floor of the arm: root of the mean square of its joints'."""
        return error_over_joints({j: d.floor.value for j, d in self.joints.items()})

    @property
    def left(self) -> float:
        """Final error in noise floors, that of the joint with most."""
        return max(d.left for d in self.joints.values())

    @property
    def left_out(self) -> tuple[str, ...]:
        """What was not searched at its joints though it usually is, in words."""
        return tuple(dict.fromkeys(words for d in self.joints.values() for words in d.left_out))

    @property
    def base_parameters(self) -> dict[str, tuple[float, float, str]]:
        """Base parameter -> (value, standard error, unit), SI; empty where none are estimated."""
        base = self.prepared.base
        if base is None:
            return {}
        numbers = zip(self.after.links, self.link_errors, base.units, strict=True)
        return dict(zip(base.names, numbers, strict=True))

    def _repr_html_(self) -> str:
        said = "; ".join(f"{joint}: {sentence(one)}" for joint, one in self.joints.items())
        return ladder_html(self.rungs, floor=self.floor, note=said)

    def __repr__(self) -> str:
        head = f"{'added':<42}{'fit error':>10}{'check error':>13}"
        lines = [head]
        for rung in self.rungs:
            name = "(your model, re-estimated)" if rung.added is None else f"+ {rung.said}"
            errors = f"{100 * rung.fit.fit_error:>9.2f}%{100 * rung.fit.check_error:>12.2f}%"
            lines.append(f"{name:<42}{errors}")
        lines.append(f"{'noise floor':<42}{'':>10}{100 * self.floor:>12.2f}%")
        lines += ["", f"{'joint':<20}{'before':>10}{'after':>10}{'floor':>10}"]
        for j, diagnosis in self.joints.items():
            before, after = self.before.check_errors[j], self.after.check_errors[j]
            shown = "".join(f"{100 * e:>9.2f}%" for e in (before, after, diagnosis.floor.value))
            lines.append(f"{j:<20}{shown}")
        lines.append("")
        for j, diagnosis in self.joints.items():
            lines.append(f"{j}: {sentence(diagnosis)}")
        aside = [str(one) for d in self.joints.values() for one in d.set_aside]
        untold = [str(one) for d in self.joints.values() for one in d.untold]
        lines += [f"cannot be told: {one}" for one in untold]
        lines += [f"set aside: {one}" for one in aside]
        lines += [f"left out: {words}" for words in self.left_out]
        names = ", ".join(map(str, self.missing))
        lines += ["", f"verdict: {self.verdict}{': ' + names if names else ''}"]
        return "\n".join(lines)
