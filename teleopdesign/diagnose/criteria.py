"""Thresholds of a diagnosis, each with its unit, its origin and the effect of another value.

A stricter value misses more effects that are present; a looser one names more that are absent.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Criteria:
    """Thresholds of a diagnosis; `CRITERIA` are those in use."""

    #: noise floors up to which what is left counts as noise. Right models reach 1.0 to 1.5 on
    #: simulated records. Lower: a right model is called incomplete; higher: a weak effect hides
    adequate: float = 1.8
    #: part of the squares above the noise floor that two effects must explain together where
    #: neither explains enough alone. Half: less is rather something else. Lower: stand-ins are
    #: accepted; higher: one pair of two is not
    mostly: float = 0.5
    #: standard deviations from which a gain is more than chance, and a parameter that makes an
    #: effect what it is differs from zero (one in 30 000 by a normal law; residuals are not quite
    #: normal). Lower: chance gains; higher: short records say nothing
    significance: float = 4.0
    #: part of the noise floor's square from which a gain counts: while a body is stuck or turns,
    #: its friction is known no better. Lower: the method's errors count; higher: weak effects
    #: are missed
    of_floor: float = 0.5
    #: part of the noise floor of a clock that jitters below which an effect leaves too little to be
    #: one: it weakens what the jitter makes. The jitter is known to a fifth, and so are two floors
    #: beside each other: by more, what is left in floors must not rise. Higher: true effects are
    #: refused; lower: a tip that moves less at high frequencies is named
    weakened: float = 0.8
    #: part of the squares before from which a gain counts, and by which two equal fits may differ:
    #: less is no answer to where a model fails
    relative_improvement: float = 0.03
    #: standard deviations of a difference below which two fits explain the records equally well.
    #: Three: one in 700 by chance. Lower: look-alikes are distinguished by chance; higher: more is
    #: undecided
    indistinguishable: float = 3.0
    #: share of the samples where the body slides that may be blind. A quarter: of more, a model
    #: says too little; less would refuse every saturation that was really reached
    blind: float = 0.25
    #: part of a new parameter's column that must lie outside the span of the model's columns:
    #: below, rounding and noise in the tangents make the difference
    least_unique_share: float = 0.02
    #: standard errors of an interval of 95 %, which must not hold the value at which an effect is
    #: absent. Of the effects accepted on simulated cases the true ones differ by 2.6 and more,
    #: three false ones by 0.4 to 1.7. Higher: weak effects are missed; lower: what absence explains
    #: as well is named
    interval: float = 2.0
    #: part of the squares that one linear step must promise, from which a start is worth a step.
    #: Higher: faster, and effects that are linear in no strength are missed
    worth: float = 0.01
    #: part of the squares of velocity near a tone above which the motion itself may have brought it
    tone_in_motion: float = 0.01
    #: the same at a frequency of the mains: a hum moves the machine by itself (0.03 to 0.12 of the
    #: squares on drawn cases). A quarter: above, the motion was driven at it. Lower: a hum is named
    #: a tip that rings; higher: what was driven at the mains' frequency passes for a hum
    hum_in_motion: float = 0.25
    #: part by which a tone may lie beside the mains: frequencies of networks and clocks of loggers
    #: are off by less. Higher: a resonance near by passes for a hum
    mains_within: float = 0.004
    #: probability of an effect that was accepted with nothing but noise left: of 74 on simulated
    #: cases 73 were true, (73 + 1)/(74 + 2)
    true_of_accepted: float = 0.97
    #: probability of a best candidate that was not accepted: of 31 none was true, 1/33
    true_of_others: float = 0.03
    #: power of the part of a free function's squares that an effect explains, by which it is
    #: believed though more than noise is left. Two: it is named from 0.72 of these squares on
    #: (0.97 x 0.72^2 = 0.5). Of 165 steps on simulated cases and recordings, 0.7 to 0.9 did nearly
    #: the same; with three, documented friction of an industrial joint (0.77) has no name. Lower:
    #: what stands in for something unknown is named; higher: true effects are not
    belief_power: float = 2.0
    #: weight of an effect beside a commoner one that explains as much. Of public recordings of
    #: revolute axes whose torque follows the place over less than a turn gravity is documented on
    #: eight, a spring or a cable's pull on two: (2 + 1)/(8 + 1). Higher: undecided more often;
    #: lower: a spring is called gravity more surely
    rarity_weight: float = 0.3
    #: rms difference of two motions, of the position over that of the motion about its mean and of
    #: the velocity over the velocity, up to which they are one motion that is made again. Passes of
    #: position-controlled machines differ by 0.0006 to 0.04, different parts of one multisine by
    #: 0.3 and more. Higher: motions that differ are compared, and more seems not to repeat
    one_motion: float = 0.05
    #: periods of the bandwidth by which one of two passes may be ahead of the other (rms). A force
    #: that varies along the travel as fast as the bandwidth shows then differs by a fifth of its
    #: squares at most. Lower: less than half of the rows that are compared; higher: a missing force
    #: is said to differ from pass to pass
    ahead: float = 0.1
    #: periods of the bandwidth that a pass holds at least, beside one cycle of the motion. Lower:
    #: the state of hidden parts, such as a bristle, comes from another past; higher: short logs
    #: have no two passes
    pass_periods: float = 8.0
    #: part of the rows that must be passed again for a statement on what repeats: fewer do not
    #: stand for the records
    passed_again: float = 0.1
    #: times that one error of a model must be another to be far larger: on check records over fit
    #: records it was 0.7 to 1.6 times on nine recordings of real machines; in the whole band over a
    #: quarter of it 0.1 to 2.6 times on 22, and 4.5 on one with a filtered potentiometer. Lower:
    #: said of chance, and of friction that jumps; higher: of other machines only
    far_larger: float = 3.0
    #: noise floors above which their number is not stated: the floor is then close to zero, because
    #: no noise of the force is stated, while real logs have noise. Lower: hides large errors;
    #: higher: a number without meaning
    countable: float = 1000.0
    #: probability from which an effect is said to be missing: less likely than not is not named
    named: float = 0.5

    @property
    def open_error(self) -> float:
        """Standard error over value from which a parameter is open: its interval holds zero."""
        return 1.0 / self.interval


#: the criteria in use; a change of one changes every answer
CRITERIA = Criteria()
