"""Smoothed Coulomb friction: the level is reached only well above a speed a.

    F = F_C v / (a + abs(v)),   level F_C abs(v) / (a + abs(v))

Many simulated devices have this friction, and motors whose drive already cancels a part of it. At
rest it holds nothing, unlike `coulomb`; far below a it is `viscous`, far above a `coulomb`. Speeds
on both sides of a distinguish it from the two together. The control law of this name is the same.
"""

from ._effect import Effect, FitSearch, Parameter


def law(now, p):
    return p.level * now.velocity / (p.smoothing_velocity + abs(now.velocity))


def plausible(p, facts):
    speed = facts.text(p.smoothing_velocity, "velocity")
    if p.smoothing_velocity > facts.speed:
        return f"no speed reaches {speed}: the effect imitates a viscous friction"
    if p.smoothing_velocity < facts.slowest:
        return f"all speeds exceed {speed}: the effect imitates Coulomb friction"
    return None


EFFECT = Effect(
    role="force",
    energy="dissipates",
    law=law,
    parameters={
        "level": Parameter("force", "F_C: friction at high speed", search=FitSearch(starts=(0.1,))),
        "smoothing_velocity": Parameter(
            "velocity",
            "a: speed at which half of the level is reached",
            search=FitSearch(starts=(0.05, 0.3)),
        ),
    },
    absent={"level": 0.0},
    after=frozenset({"coulomb"}),
    plausible=plausible,
    source="Bernstein, Lawrence, Pao, World Haptics 2005, eq (6)",
)
