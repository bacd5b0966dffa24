"""Certificates of kind "storage": a storage function V, and an identity for each inequality.

Names are constants, signals (functions of time), states (with a rate each) and, for each x in
`signs`, abs_x = |x| and sign_x (1 for x > 0, -1 for x < 0, either for x = 0).

Theorem. Assume that at all times every expression in `positive` is > 0 and every expression in
`nonnegative` is >= 0; that signals and the rates of invariants are locally bounded; that the states
are absolutely continuous, with x' = rate at almost every time; and that every invariant h is >= 0
at the start. Then h >= 0 and V >= 0 at all times, and the integral of the supply is at least the
change of V, with V = 0 at rest. So it is never below -V(start), and from rest never below 0.

Proof.
(1) V and h contain constants and states only; assumptions contain constants and signals only. All
divisors are products of `positive` expressions. So all expressions are defined, V and h are locally
Lipschitz, and along a motion V and h are absolutely continuous in time.
(2) For each combination of signs (x = s X, X = |x| >= 0) the expressions h' + rate h, V and
supply - V' are identically sums of terms weight * factors^powers * square. Weights are rational and
>= 0. Factors are |x|, assumptions and invariants (no invariants in the terms of an h). Powers are
integers, below 0 only for `positive`. So each sum is >= 0.
(3) V and h may depend on |e| or sign_e of a state e, if both sides agree at e = 0 and no rate
depends on sign_e. At almost every time with e = 0 also e' = 0. So both sides have the same V', and
this is the true one.
(4) From h' >= -rate h follows h >= 0: multiply by the exponential of the integral of the rate. From
V' <= supply the bound follows by integration.
(5) Where the statement allows sign_x "from -1 to 1" at x = 0 (sticking friction), the supply and
all rates are affine in sign_x there. The inequalities are shown for -1 and 1, so they also hold for
all values between.
The example in the certificate meets all assumptions, as stated and at rest. So the assumptions do
not contradict each other.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from .algebra import Algebra, Poly, Quotient, expect, expect_fields, flat, read_number, read_words
from .effort import DEGREE, EFFORT, SIGNS, need


@dataclass(frozen=True)
class Meaning:
    """The expressions of a storage certificate, for one combination of signs or in general.

    assumed: expressions that are assumed to be > 0 or >= 0;  invariants: h, by name
    decays: rate of each invariant;  rates: x' of each state;  signs: x -> 1 or -1
    """

    algebra: Algebra
    assumed: dict[str, Quotient]
    invariants: dict[str, Quotient]
    decays: dict[str, Quotient]
    rates: dict[str, Quotient]
    storage: Quotient
    supply: Quotient
    signs: dict[str, int]

    @property
    def factors(self) -> dict[str, Quotient]:
        """Expressions that are known to be >= 0: assumptions, invariants and sizes |x|."""
        sizes = {f"abs_{x}": Quotient(self.algebra.name(f"abs_{x}"), {}) for x in self.signs}
        return self.assumed | self.invariants | sizes

    @property
    def goals(self) -> dict[str, Quotient]:
        """Expressions that the proofs have to show to be >= 0: V, supply - V', h' + rate h."""
        algebra = self.algebra
        goals = {"storage": self.storage}
        goals["supply"] = algebra.sum(self.supply, self._change(self.storage), -1)
        for n, h in self.invariants.items():
            goals[n] = algebra.sum(self._change(h), algebra.product(self.decays[n], h))
        return goals

    def _change(self, e: Quotient) -> Quotient:
        """Rate of change of e: sum over states of slope times rate; no state is in a divisor."""
        total = Quotient({}, {})
        for x, rate in self.rates.items():
            i = self.algebra.names.index(x)
            slope: Poly = {}
            for k, a in e.above.items():
                if k[i]:
                    slope[(*k[:i], k[i] - 1, *k[i + 1 :])] = k[i] * a
            one = self.algebra.product(Quotient(slope, e.below), rate)
            total = self.algebra.sum(total, one, self.signs.get(x, 1))
        return total


class Storage:
    """The content of a storage certificate; all rules are checked here but the identities."""

    def __init__(self, c: dict[str, Any]) -> None:
        expect_fields(c, "kind", "title", "digest", "constants", "signals", "rates", "signs",
                      "positive", "nonnegative", "invariant", "supply", "storage", "proofs",
                      "example")  # fmt: skip
        for field in ("positive", "nonnegative", "invariant", "rates", "proofs", "example"):
            expect(dict, c[field], field)
        self.c, self.signs, self.states = (
            c,
            read_words(c["signs"], "signs"),
            read_words([*c["rates"]], "rates"),
        )
        self.constants, self.signals = (read_words(c[k], k) for k in ("constants", "signals"))
        self.words = read_words([*self.constants, *self.signals, *self.states], "names")
        need(not any(n.startswith(("abs_", "sign_")) for n in self.words), "abs_, sign_ declared")
        need({*self.signs} <= {*self.signals, *self.states}, "signs: neither signal nor state")
        need(len(self.signs) <= SIGNS, f"signs: more than {SIGNS}")
        factors = [*c["positive"], *c["nonnegative"], *c["invariant"]]
        read_words([*factors, "storage", "supply", *(f"abs_{x}" for x in self.signs)], "factors")
        need(self.states or not c["invariant"], "an invariant without states")
        for n, h in c["invariant"].items():
            expect_fields(expect(dict, h, n), "expression", "rate")
        self.left = [EFFORT]
        self.affine = self._check_dependence()
        self.cases = [
            self._meaning(dict(zip(self.signs, signs, strict=True)))
            for signs in itertools.product((1, -1), repeat=len(self.signs))
        ]
        for case in self.cases:
            self._check_example(case)

    def _meaning(self, signs: dict[str, int], zero: str = "") -> Meaning:
        """Expressions with x = sign * |x| for x in `signs`, the name x standing for |x|.

        zero: a name that is replaced by 0
        """
        c, names = self.c, [*self.words, *(p + x for x in self.signs for p in ("abs_", "sign_"))]
        algebra = Algebra(names, self.left)
        for x, s in signs.items():
            size = {} if x == zero else algebra.name(x)
            algebra.put[x] = {k: s * a for k, a in size.items()}
            algebra.put[f"abs_{x}"], algebra.put[f"sign_{x}"] = size, algebra.number(s)
        if zero:
            algebra.put[zero] = algebra.put[f"abs_{zero}"] = {}
        read = algebra.read
        positive = {n: read(e) for n, e in c["positive"].items()}
        need(not any(e.below for e in positive.values()), "positive: a division")
        algebra.bases.update({n: e.above for n, e in positive.items()})
        return Meaning(
            algebra,
            positive | {n: read(e) for n, e in c["nonnegative"].items()},
            {n: read(h["expression"]) for n, h in c["invariant"].items()},
            {n: read(h["rate"]) for n, h in c["invariant"].items()},
            {x: read(e) for x, e in c["rates"].items()},
            read(c["storage"]),
            read(c["supply"]),
            signs,
        )

    def _check_dependence(self) -> list[str]:
        """Check steps (1) and (3) of the proof; returns the names x for which step (5) holds."""
        general = self._meaning({})
        uses, inner = general.algebra.uses, [general.storage, *general.invariants.values()]
        free = {*self.constants, *self.signals, *(f"abs_{x}" for x in self.signs)}
        free -= {f"abs_{x}" for x in self.states}
        for n, e in general.assumed.items():
            need(uses(e) <= free, f"{n}: a state or a sign is assumed")
        bent = [x for x in self.states if {f"abs_{x}", f"sign_{x}"} & uses(*inner)]
        held = {*self.constants, *self.states, *(p + x for x in bent for p in ("abs_", "sign_"))}
        need(uses(*inner) <= held, "V or h depends on a signal")
        for x in bent:
            need(f"sign_{x}" not in uses(*general.rates.values()), f"V or h bends, {x}' jumps")
            right, left = (self._meaning({x: s}, zero=x) for s in (1, -1))
            same = (right.storage, right.invariants) == (left.storage, left.invariants)
            need(same, f"V or h jumps at {x} = 0")
        rest = [
            i for i, n in enumerate(general.algebra.names) if n.removeprefix("abs_") in self.states
        ]
        need(all(any(k[i] for i in rest) for k in general.storage.above), "V is not 0 at rest")
        return [x for x in self.signs if self._is_affine(x)]

    def _is_affine(self, x: str) -> bool:
        """Whether the supply and all rates are affine in sign_x at x = 0."""
        m = self._meaning({}, zero=x)
        i = m.algebra.names.index(f"sign_{x}")
        quotients = [m.supply, *m.rates.values(), *m.decays.values()]
        return all(k[i] < 2 for e in quotients for k in e.above)

    def _check_example(self, case: Meaning) -> None:
        """Raise Refused unless the example meets all assumptions, as stated and at rest."""
        example = {n: read_number(x, "example") for n, x in self.c["example"].items()}
        need({*example} <= {*self.words}, "example: an unknown name")
        need(all(example.get(x, 0) >= 0 for x in self.signs), "example: a size below 0")
        rest = {x: Fraction(0) for x in (*self.states, *self.signs)}
        for at, (n, e) in itertools.product((rest | example, example | rest), case.factors.items()):
            missing = case.algebra.uses(e) - {*at}
            need(not missing, f"example: no value of {', '.join(sorted(missing))}")
            value = case.algebra.value(e.above, at)  # what is below is itself shown to be > 0
            holds = value > 0 or (value == 0 and n not in self.c["positive"])
            need(holds, f"example: {n} does not hold")

    def check_proofs(self) -> None:
        """Check step (2) of the proof: each inequality by its identity; raises Refused if not."""
        proofs = self.c["proofs"]
        goals = {"storage", "supply", *self.c["invariant"]}
        need({*proofs} == goals, f"proofs: expected exactly {', '.join(sorted(goals))}")
        cases = {" ".join(map(str, case.signs.values())): case for case in self.cases}
        for goal, by_signs in proofs.items():
            need({*expect(dict, by_signs, goal)} == {*cases}, f"{goal}: signs missing or unknown")
        for signs, case in cases.items():
            for goal, left in case.goals.items():
                for term in expect(list, proofs[goal][signs], goal):
                    left = case.algebra.sum(left, self._term(case, goal, term), -1)
                need(not left.above, f"{goal}: no identity")

    def _term(self, case: Meaning, goal: str, term: Any) -> Quotient:
        """A term >= 0, weight * factors^powers * e^2, from [weight, {factor: power}, text of e]."""
        need(type(term) is list and len(term) == 3, f"{goal}: expected weight, powers, square")
        algebra, weight = case.algebra, read_number(term[0], goal)
        need(weight >= 0, f"{goal}: a negative weight")
        square = algebra.read(term[2])
        product = algebra.product(Quotient(algebra.number(weight), {}), square)
        product = algebra.product(product, square)
        known = case.factors
        for n, power in expect(dict, term[1], goal).items():
            fits = n in known and not {n, goal} <= {*case.invariants}
            need(fits, f"{goal}: a factor that is not known to be >= 0")
            need(abs(expect(int, power, goal)) <= DEGREE, f"{goal}: a power too large")
            need(power >= 0 or n in self.c["positive"], f"{goal}: divides by what may be 0")
            below = {b: k * power for b, k in known[n].below.items()} if power > 0 else {n: -power}
            above = algebra.power(known[n].above, max(power, 0))
            product = algebra.product(product, Quotient(above, below if power else {}))
        return product

    def statement(self) -> str:
        """The statement that the certificate proves, in words, made from its content alone."""
        c = self.c
        supply = flat(c["supply"])
        assumed = [f"{flat(e)} > 0" for _, e in sorted(c["positive"].items())]
        assumed += [f"{flat(e)} >= 0" for _, e in sorted(c["nonnegative"].items())]
        invariants = [h for _, h in sorted(c["invariant"].items())]
        start = ", ".join(f"{flat(h['expression'])} >= 0" for h in invariants)
        decays = ", ".join(sorted({flat(h["rate"]) for h in invariants}))
        parts = []
        if self.states:
            parts += [f"the integral of {supply} is never less than the change of the storage V"]
            parts += [f"V = {flat(c['storage'])} >= 0 (V = 0 at rest)"]
            parts += [f"where d/dt {x} = {flat(e)}" for x, e in sorted(c["rates"].items())]
            if invariants:
                parts += [f"from every start with {start}, kept for locally bounded {decays}"]
        else:
            parts += [f"{supply} >= 0"]
        parts += [f"for {k} {', '.join(c[k])}" for k in ("constants", "signals") if c[k]]
        for x in self.signs:
            zero = "from -1 to 1" if x in self.affine else "1 or -1"
            parts += [f"sign_{x} is the sign of {x}, at 0 {zero}; abs_{x} = sign_{x}*{x}"]
        parts += [f"as long as {', '.join(assumed)}"] if assumed else []
        values = ", ".join(f"{n} = {x}" for n, x in sorted(c["example"].items()))
        return "; ".join(parts + ([f"met for example by {values}"] if values else []))
