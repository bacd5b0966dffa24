"""The blocks C, H and K of the haptic interface: P12 to P15, from the laws of the controllers.

Also statements of the first paper that rest on its experiments and users: P24 to P26.
"""

from __future__ import annotations

import sympy as sp

from ..controllers import CONTROLLERS, SIGNALS, controller, scheduled_force_feedback
from ._laws import coulomb, schedule, smoothed_coulomb
from ._proof import Equal, Holds, Limit, NotNegative, ProofSteps, proof
from ._statement import BERNSTEIN, claim, shows

v, a, b, k, F_C = sp.symbols("v a b k F_C", positive=True)
UP, DOWN = smoothed_coulomb(v, F_C, a), smoothed_coulomb(-v, F_C, a)
SLOPE = sp.diff(UP, v)


@shows(12, BERNSTEIN, "eqs (1), (6)")
def smoothed_friction() -> ProofSteps:
    """Smoothed Coulomb friction is odd, increasing, below F_C and steepest at 0 with slope F_C/a.
    The Coulomb friction that remains after its cancellation has the shape of the schedule of H.

    formula: F_S = F_C v/(a + abs(v));  F_C sgn(v) - F_S = F_C sgn(v) a/(a + abs(v))
    printed: digits of a are lost: 5, 15, 50 or 150 mm/s; no result here depends on it
    """
    left = coulomb(v, F_C) - UP
    return proof(
        Equal("odd", DOWN, -UP),
        NotNegative("increasing", SLOPE, F_C * a / (a + v) ** 2, strictly=True),
        NotNegative("below F_C", F_C - UP, F_C * a / (a + v), strictly=True),
        Limit("slope at 0", SLOPE, v, sp.S(0), F_C / a),
        NotNegative(
            "nowhere steeper", F_C / a - SLOPE, F_C * (2 * a * v + v**2) / (a * (a + v) ** 2)
        ),
        Equal("what is left", left, F_C * a / (a + v)),
        Equal("the shape of the schedule", (left / F_C).subs(a, b), schedule(v, k, b) / k),
    )


@shows(13, BERNSTEIN, "blocks C and H")
def residual_friction_of_the_hybrid() -> ProofSteps:
    """Friction that remains with the hybrid in quasi-static motion, and when slow motion has more
    of it.

    formula: r(v) = F_C a (b + abs(v))/((a + abs(v)) (b + abs(v) + k b)),  r(0) = F_C/(1 + k); falls
        with abs(v) throughout iff b (1 + k) >= a k
    printed: digits of k and b are lost (5, 15, 50; 8, 80, 18, 180, 800 mm/s)
    """
    r = (coulomb(v, F_C) - UP) / (1 + schedule(v, k, b))
    falls = b * (1 + k) - a * k
    bracket = v**2 + 2 * b * v + b * falls
    positive = F_C * a / ((a + v) ** 2 * (b + v + k * b) ** 2)
    h, e = sp.Symbol("h", nonnegative=True), sp.Symbol("e", positive=True)
    early = bracket.subs(a, (b * (1 + k) + e) / k)
    return proof(
        Equal("by the laws of C and H", r, F_C * a * (b + v) / ((a + v) * (b + v + k * b))),
        Limit("at rest", r, v, sp.S(0), F_C / (1 + k)),
        Equal("its slope", sp.diff(r, v), -positive * bracket),
        NotNegative(
            "falls throughout where b (1 + k) >= a k", bracket, v**2 + 2 * b * v + b * h, {h: falls}
        ),
        Limit(
            "otherwise, b (1 + k) = a k - e with e > 0, it rises at first: minus the bracket "
            "starts at b e > 0",
            -early,
            v,
            sp.S(0),
            b * e,
        ),
        assuming=[falls],
    )


@shows(14, BERNSTEIN, "block H")
def place_of_the_schedule() -> ProofSteps:
    """A schedule before the filter and one after it are the same at constant speed, but not when
    speed changes.

    formula: before: tau w' = g(v) e - w, output w;  after: tau w' = e - w, output g(v) w
    printed: does not say whether the schedule acts before the low-pass or after it
    """
    orders = [
        scheduled_force_feedback(gain=1, scheduling_velocity=1, bandwidth=1, schedule=order)
        for order in ("before", "after")
    ]
    s = sp.Symbol("s")
    forms = [c.linear_form("H", s, v) for c in orders]
    error, speed = SIGNALS["input"], SIGNALS["speed"]
    fast = sp.Symbol("fast", positive=True)
    # the filter is in steady state at speed v, then the speed jumps: outputs just after the jump
    outputs = []
    for equation in (c.equation("H", SIGNALS) for c in orders):
        (state,) = equation.rates
        steady_state = sp.solve(equation.rates[state].subs(speed, v), state)[0]
        outputs.append(equation.output.subs(speed, fast).subs(state, steady_state))
    values = {error: 1, v: 1, fast: 3}
    numbers = {x: 1 for e in outputs for x in e.free_symbols if x not in (error, speed, v, fast)}
    return proof(
        Equal("one transfer function at frozen speed", forms[0], forms[1]),
        Equal("before: a jump of speed does not pass at once", sp.diff(outputs[0], fast), 0),
        Holds(
            "after: it does, gain 1/(1 + 3) in place of 1/(1 + 1) at k = b = 1",
            (outputs[0] - outputs[1]).subs(numbers).subs(values),
            "!=",
            0,
        ),
    )


@shows(15, BERNSTEIN, "eq (8)")
def position_loop_against_friction() -> ProofSteps:
    """With a position loop that is too soft at zero frequency the rod stays stuck under a slow
    reference. For a lead the condition at zero frequency is the strictest.

    formula: a slow reference of amplitude A moves the rod only if abs(K(0)) A > F_C;  K(0) = g z/p
    printed: digits of g, z and p are lost; K is not recovered
    """
    g, z, d, w, part = sp.symbols("g z d omega part", positive=True)
    p = z + d  # a lead: the pole lies beyond the zero
    s = sp.Symbol("s")
    stage = controller("lead", {n: 1 for n in CONTROLLERS["lead"].parameters})
    names = {"gain": g, "zero": z, "pole": p}
    form = sp.sympify(stage.linear_form("K", s, v))
    form = form.subs({x: names[x.name.split("_")[-1]] for x in form.free_symbols if x != s})
    size = (form * form.subs(s, -s)).subs(s, sp.I * w)
    hold = sp.Symbol("hold", nonnegative=True)
    amplitude = sp.Symbol("A", positive=True)
    stiff = g * z / p
    return proof(
        Equal("stiffness at zero frequency", form.subs(s, 0), stiff),
        NotNegative(
            "stuck at L = 0 the loop pushes with K(0) L_D, at most K(0) A: friction balances it",
            F_C - stiff * amplitude * part / (1 + part),
            hold + stiff * amplitude / (1 + part),
            {hold: F_C - stiff * amplitude},
        ),
        NotNegative(
            "a lead is stiffer at every other frequency: abs(K(j omega)) > K(0)",
            sp.simplify(size - stiff**2),
            g**2 * w**2 * d * (2 * z + d) / (p**2 * (w**2 + p**2)),
        ),
        assuming=[F_C - stiff * amplitude],
    )


two_compensators = claim(
    24,
    BERNSTEIN,
    "comparison of the two methods",
    "Motion-based cancellation needs an accurate model, cannot act before motion and "
    "suffers from delay at reversals. Force feedback needs neither model nor motion, and its "
    "roll-off limits it.",
    (13, 38, 47, 48),
)
users = claim(
    25,
    BERNSTEIN,
    "experiments",
    "Four users felt least friction with the hybrid. The model omits low-velocity detail on "
    "purpose. a and b were tuned by hand. F_C is half the force difference between motion up and "
    "motion down.",
    (13,),
)
untested = claim(
    26,
    BERNSTEIN,
    "text",
    "Independence of amplitude was not a design goal, and 4 to 20 Hz was not tested.",
    (20, 22),
)
