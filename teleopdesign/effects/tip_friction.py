"""Tip friction: dry friction beyond the compliance or the backlash of a transmission.

    m_t dv_t/dt = coupling + interaction force - F_t sgn(v_t);   stuck: whatever balances, up to F_t

Examples are gears, whose bearings and seals hold the side of the load, and instruments behind
cables. At a reversal the actuator winds the transmission up by 2 F_t before the tip follows. This
hysteresis has the stiffness K. It looks like `presliding`, and like `backlash` where K is high. A
soft transmission with this friction also imitates the Coulomb friction of the actuator, so it is a
candidate only beside `coulomb`.
"""

from ._effect import Effect, FitSearch, Parameter

#: names of the stiffness that connects the tip to the body, for either structure
JOINED = ("transmission_compliance.stiffness", "backlash.stiffness")


def law(now, p):
    return p.level


def plausible(p, facts):
    stiffness = [v for n, v in facts.body.items() if n in JOINED]
    if not stiffness:
        return None
    # at a reversal the transmission is wound from one side to the other
    wound = 2.0 * p.level / max(stiffness)
    sentence = f"a friction of {facts.text(p.level, 'force')} winds the transmission up by "
    sentence += facts.text(wound, "position")
    if wound < 0.5 * facts.step:
        step = facts.text(facts.step, "position")
        return f"{sentence}, below the step of {step}: the effect imitates friction of the actuator"
    if wound > facts.travel:
        travel = facts.text(facts.travel, "position")
        return f"{sentence}, more than the travel of {travel}: the effect imitates a spring"
    return None


EFFECT = Effect(
    role="tip_level",
    energy="dissipates",
    law=law,
    parameters={
        "level": Parameter(
            "force", "F_t: friction force while the tip slides", search=FitSearch(starts=(0.1,))
        )
    },
    absent={"level": 0.0},
    plausible=plausible,
    needs=frozenset({"transmission_compliance"}),
    after=frozenset({"coulomb"}),
    always=frozenset({"even in velocity", "non-negative"}),
    source="two masses on a spring with friction on both; Spong, J. Dyn. Sys. Meas. Control 109 "
    "(1987) 310, with Coulomb friction of the link",
)
