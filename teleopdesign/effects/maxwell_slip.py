"""Maxwell slip: before sliding, friction is a hysteresis of two to four springs that slip in turn.

    F = sum F_i,   dF_i/dt = K_i v while abs(F_i) < W_i level/F_C, held there,   sum W_i = F_C

The contact becomes softer with the distance since a reversal; one bristle (`presliding`) has one
curve for all loops. Element 1 carries the part of the Coulomb level F_C that the other elements
leave. Where the level grows with speed, load or place, all elements slip at as much more. A record
shows the effect where the encoder resolves the deflection.
"""

from sympy import Max

from ._effect import Effect, FitSearch, Parameter, State, parameter_symbol
from ._elements import MORE, elements_slip, softest_first

COULOMB = parameter_symbol("coulomb", "level")
#: N or N m: far below any friction; keeps the law defined where there is none
NO_LEVEL = 1e-30


def law(now, p):
    return sum(getattr(now, f"force_{i}") for i in (1, *MORE))


def element(i):
    def slip(now, p):
        others = sum(getattr(p, f"level_{j}") for j in MORE)
        slips = getattr(p, f"level_{i}") if i in MORE else Max(COULOMB - others, 0)
        return slips * now.level / Max(COULOMB, NO_LEVEL)

    return State("force", lambda now, p: getattr(p, f"stiffness_{i}") * now.velocity, stop=slip)


# the starts are all soft to all stiff, each element some times stiffer than the one before: from
# starts with less order the search stopped at worse values in four cases of ten
def of_element(i, quantity, meaning, *starts, of=""):
    within = 1e4 if i > 2 else float("inf")  # 3, 4: may be rigid
    search = FitSearch(starts=starts, of=of, within=within)
    return Parameter(quantity, f"{meaning} of element {i}", optional=i > 2, search=search)


EFFECT = Effect(
    role="friction_shape",
    energy="dissipates",
    law=law,
    states={f"force_{i}": element(i) for i in (1, *MORE)},
    parameters={
        "stiffness_1": of_element(1, "stiffness", "K_1: stiffness", 0.1, 0.3, 1.0, 3.0, 10.0),
        "stiffness_2": of_element(2, "stiffness", "K_2: stiffness", 3.0, 10.0, of="stiffness_1"),
        "level_2": of_element(2, "force", "W_2: slip level", 0.25),
        "stiffness_3": of_element(3, "stiffness", "K_3: stiffness", 3.0, of="stiffness_2"),
        "level_3": of_element(3, "force", "W_3: slip level", 0.25),
        "stiffness_4": of_element(4, "stiffness", "K_4: stiffness", 3.0, of="stiffness_3"),
        "level_4": of_element(4, "force", "W_4: slip level", 0.25),
    },
    absent={"stiffness_1": float("inf"), "stiffness_2": float("inf")},
    order=softest_first,
    plausible=elements_slip,
    needs=frozenset({"coulomb"}),
    source="Al-Bender, Lampaert, Swevers, IEEE TAC 50 (2005); Iwan, J. Appl. Mech. 33 (1966)",
)
