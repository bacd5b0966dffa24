"""Maxwell slip: before it slides friction is a hysteresis of two to four springs that slip in turn.

    F = sum F_i,   dF_i/dt = K_i v while abs(F_i) < W_i, held there;   W_1 = level - W_2 - W_3 - W_4

The contact grows softer with the way since a reversal, and inner loops are scaled parts of the
outer one: one bristle (`presliding`) has one curve for all. The first element carries what the
others leave of the friction level. Seen only in motion that the encoder resolves.
"""

from sympy import Max

from ._effect import Effect, FitSearch, Parameter, State

MORE = (2, 3, 4)


def law(now, p):
    return sum(getattr(now, f"force_{i}") for i in (1, *MORE))


def element(i):
    def rate(now, p):
        return getattr(p, f"stiffness_{i}") * now.velocity

    def slip(now, p):
        others = sum(getattr(p, f"level_{j}") for j in MORE)
        return getattr(p, f"level_{i}") if i in MORE else Max(now.level - others, 0)

    return State("force", rate, stop=slip)


def of_element(i, quantity, meaning, *starts):
    # one that is added to two may as well be rigid
    search = FitSearch(starts=starts, within=1e4 if i > 2 else float("inf"))
    return Parameter(quantity, f"{meaning} of element {i}", optional=i > 2, search=search)


def plausible(p, facts):
    slips = {i: getattr(p, f"level_{i}") for i in MORE}
    slips[1] = facts.body["coulomb.level"] - sum(slips.values())
    gives = [slips[i] / getattr(p, f"stiffness_{i}") for i in slips if slips[i] > 0.0]
    # what gives by less than half a step is never read; what never slips is a spring
    if any(0.5 * facts.step < way < facts.travel for way in gives):
        return None
    if gives and max(gives) >= facts.travel:
        travel = facts.text(facts.travel, "position")
        return f"no element slips within the travel of {travel}: it stands for a spring"
    step = facts.text(facts.step, "position")
    return f"every element gives by less than steps of {step} show: it stands for sgn friction"


EFFECT = Effect(
    role="friction_shape",
    energy="dissipates",
    law=law,
    states={f"force_{i}": element(i) for i in (1, *MORE)},
    parameters={
        "stiffness_1": of_element(1, "stiffness", "K_1: stiffness", 10.0, 100.0, 1e3),
        "stiffness_2": of_element(2, "stiffness", "K_2: stiffness", 1.0, 10.0, 100.0),
        "level_2": of_element(2, "force", "W_2: slip level", 0.3),
        "stiffness_3": of_element(3, "stiffness", "K_3: stiffness", 30.0),
        "level_3": of_element(3, "force", "W_3: slip level", 0.03),
        "stiffness_4": of_element(4, "stiffness", "K_4: stiffness", 0.3),
        "level_4": of_element(4, "force", "W_4: slip level", 0.03),
    },
    absent={"stiffness_1": float("inf"), "stiffness_2": float("inf")},
    plausible=plausible,
    needs=frozenset({"coulomb"}),
    source="Al-Bender, Lampaert, Swevers, IEEE TAC 50 (2005) 1883; Iwan, J. Appl. Mech. 33 "
    "(1966) 893",
)
