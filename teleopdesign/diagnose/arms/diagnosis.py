"""The diagnosis of an arm: a ladder of effects at its joints, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ...base.frozen import ByValue
from ...base.shown import figure_of
from ...measurement.experiment import Experiment
from ..candidates import Candidate
from ..diagnosis import Diagnosis
from ..ladder_text import describe_addition, ladder_html, sentence
from ..learnable import Learnable
from ..left_out import left_out_lines
from ..ranking import named_instead
from ..record_shift import shifts_of
from ..rung import Rung
from .fit import ArmFit, error_over_joints
from .prepared import PreparedArm

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class ArmRung(ByValue):
    """One step of an arm's ladder: the added effect with its joint, and the fit of the arm.

    added: None: the rung of the user's model
    instead_of: the effect of the user's model that the added one replaced
    other: the joint whose motion is the channel `other_position` at the effect's joint
    """

    added: Candidate | None
    fit: ArmFit
    instead_of: Candidate | None = None
    other: str | None = None

    @property
    def follows(self) -> str | None:
        """The joint whose motion the added effect depends on; None: on no other joint's."""
        if self.added is None or "other_position" not in self.added.effect.channels():
            return None
        return self.other

    @property
    def title(self) -> str:
        """The added effect in words."""
        if self.added is None:
            return ""
        words = named_instead(self.added, self.instead_of)
        return words if self.follows is None else f"{words} by the motion of {self.follows}"


@dataclass(frozen=True, eq=False)
class ArmDiagnosis(ByValue):
    """Result of a diagnosis of an arm: the ladder of effects at its joints, and the verdict.

    verdict: "effects_missing", "model_adequate" or "undecided"
    rungs: the user's model re-estimated, then one rung per effect, over all joints
    joints: joint -> its diagnosis, with the information of the other joints on the links
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
        """The fit of the user's model, re-estimated."""
        return self.rungs[0].fit

    @property
    def after(self) -> ArmFit:
        """The fit of the model with every accepted effect."""
        return self.rungs[-1].fit

    def _at_its_joint(self, added: Candidate) -> Rung:
        """The rung that added the effect, in the ladder of its joint."""
        rungs = self.joints[added.at].rungs
        return next(r for r in rungs if r.added is not None and r.added.key == added.key)

    @property
    def missing(self) -> tuple[Candidate, ...]:
        """Effects that are called missing, in the order added."""
        named = {c.key for d in self.joints.values() for c in d.missing}
        return tuple(r.added for r in self.rungs if r.added is not None and r.added.key in named)

    @property
    def floor(self) -> float:
        """Noise floor of the arm: root mean square of the floors of its joints."""
        return error_over_joints({j: d.floor.value for j, d in self.joints.items()})

    @property
    def left(self) -> float:
        """Final error as a multiple of the noise floor, at the joint where it is largest."""
        return max(d.left for d in self.joints.values())

    @property
    def learnable(self) -> Learnable | None:
        """The part of all joints' residuals that could be learned; None without the extra `learn`.

        Errors are over all joints, as in the ladder; each joint's diagnosis says where the learned
        force lies.
        """
        boxes = {j: d.learnable for j, d in self.joints.items() if d.learnable is not None}
        if len(boxes) < len(self.joints):
            return None
        # trees that make a joint worse are not used there
        return Learnable(
            left=error_over_joints({j: b.left for j, b in boxes.items()}),
            error=error_over_joints({j: min(b.error, b.left) for j, b in boxes.items()}),
            alone=error_over_joints({j: b.alone for j, b in boxes.items()}),
        )

    @property
    def left_out(self) -> tuple[str, ...]:
        """Parts of a full search that were left out at its joints, in words."""
        return tuple(dict.fromkeys(words for d in self.joints.values() for words in d.left_out))

    @property
    def base_parameters(self) -> dict[str, tuple[float, float, str]]:
        """Base parameter -> (value, standard error, unit), SI; empty where none is estimated."""
        base = self.prepared.base
        if base is None:
            return {}
        numbers = zip(self.after.links, self.link_errors, base.units, strict=True)
        return dict(zip(base.names, numbers, strict=True))

    def plot(self) -> Figure:
        """Figure of force and residual of each joint, and of the ladder of the arm."""
        return figure_of(self)

    def _repr_html_(self) -> str:
        sentences = "; ".join(f"{joint}: {sentence(one)}" for joint, one in self.joints.items())
        return ladder_html(self.rungs, floor=self.floor, note=sentences)

    def __repr__(self) -> str:
        head = f"{'added':<42}{'fit error':>10}{'check error':>13}"
        lines = [head]
        for rung in self.rungs:
            name = "(your model, re-estimated)" if rung.added is None else f"+ {rung.title}"
            errors = f"{100 * rung.fit.fit_error:>9.2f}%{100 * rung.fit.check_error:>12.2f}%"
            lines.append(f"{name:<42}{errors}")
            if rung.added is not None:
                lines += describe_addition(
                    self.joints[rung.added.at], self._at_its_joint(rung.added)
                )
        lines.append(f"{'noise floor':<42}{'':>10}{100 * self.floor:>12.2f}%")
        lines += ["", f"{'joint':<20}{'before':>10}{'after':>10}{'floor':>10}"]
        for j, diagnosis in self.joints.items():
            before, after = self.before.check_errors[j], self.after.check_errors[j]
            shown = "".join(f"{100 * e:>9.2f}%" for e in (before, after, diagnosis.floor.value))
            lines.append(f"{j:<20}{shown}")
        for j, diagnosis in self.joints.items():
            lines += ["", *self._describe_joint(j, diagnosis)]
        lines += [""] * bool(self.left_out) + [f"left out: {words}" for words in self.left_out]
        names = ", ".join(map(str, self.missing))
        lines += ["", f"verdict: {self.verdict}{': ' + names if names else ''}"]
        return "\n".join(lines)

    def _describe_joint(self, joint: str, diagnosis: Diagnosis) -> list[str]:
        """Lines on one joint: its verdict, and its remaining error."""
        lines = [f"{joint}: {sentence(diagnosis)}"]
        shifts = shifts_of(diagnosis.model, diagnosis.prepared.stretches)
        lines += [f"  {shift}" for shift in shifts]
        if (near := diagnosis.near_reversals) is not None:
            lines.append(f"  check error {near}")
        if diagnosis.learnable is not None:
            lines.append(f"  black box: {diagnosis.learnable}")
        if diagnosis.repeats is not None:
            lines.append(f"  repeats: {diagnosis.repeats}")
        if diagnosis.more_is_missing:
            lines += [f"  {line}" for line in left_out_lines(diagnosis)]
        return [*lines, *(f"  set aside: {one}" for one in diagnosis.set_aside)]
