# mypy: ignore-errors
"""Check certificates of passivity: `python check_certificate.py FILE ...`; needs sympy alone.

storage: V, supply - dV/dt and h' + rate h (invariants h >= 0) are sums of weight * factors * square
>= 0, for both signs of each x in `signs`; positive real: S = (Z - 1)/(Z + 1) is bounded real."""

import hashlib, itertools, json, re, sys, sympy as sp  # noqa: E401, I001


def _need(condition, problem):
    if not condition:
        raise ValueError(f"refused: {problem}")


def _read(text: str, names: dict) -> sp.Expr:
    _need({*re.findall(r"[A-Za-z_]\w*|[^\w\s+*/()-]", text, re.ASCII)} <= {*names}, text)
    return sp.sympify(text, locals=names)


def _storage(c, signs):
    sym, poles = {n: sp.Symbol(n, real=True) for n in c["symbols"]}, set()
    signs = dict(zip(c["signs"], signs, strict=True))
    put = {sym["sign_" + x]: s for x, s in signs.items()}
    put |= {sym["abs_" + x]: sym[x] for x in signs} | {sym[x]: signs[x] * sym[x] for x in signs}

    def get(text):
        e = _read(text, sym).subs(put, simultaneous=True)
        roots = {f for f, _ in sp.factor_list(sp.denom(sp.together(e)))[1]}
        _need(all({f, -f} & poles for f in roots), f"may divide by zero: {text}")
        return e

    known = {n: get(text) for n, text in (c["nonnegative"] | c["positive"]).items()}
    poles = {f for n in c["positive"] for f, _ in sp.factor_list(known[n])[1]}
    at = {sym[x]: _read(number, {}) for x, number in c["example"].items()}
    for n, e in known.items():  # one example meets all that is assumed
        _need(e.subs(at) > 0 or (e.subs(at) == 0 and n in c["nonnegative"]), f"example: {n}")
    rates = {sym[x]: signs.get(x, 1) * get(text) for x, text in c["rates"].items()}
    _need(not any(e.free_symbols & set(rates) for e in known.values()), "a state is assumed")
    inner = {n: get(h["expression"]) for n, h in c["invariant"].items()}
    known |= inner | {"abs_" + x: sym[x] for x in signs}
    inner["storage"] = get(c["storage"])
    fixed = {sym[n] for n in c["constants"]} | set(rates)
    _need(all(e.free_symbols <= fixed for e in inner.values()), "V or h depends on a signal")
    change = {n: sum(sp.diff(e, x) * r for x, r in rates.items()) for n, e in inner.items()}
    goals = {n: change[n] + get(h["rate"]) * inner[n] for n, h in c["invariant"].items()}
    goals |= {"storage": inner["storage"], "supply": get(c["supply"]) - change["storage"]}
    for n, goal in goals.items():
        for w, powers, square in c["proofs"][n][" ".join(map(str, signs.values()))]:
            _need(_read(w, {}) >= 0 and {f for f in powers if powers[f] < 0} <= {*c["positive"]}, n)
            goal -= _read(w, {}) * get(square) ** 2 * sp.prod(known[f] ** powers[f] for f in powers)
        _need(sp.expand(sp.numer(sp.together(goal))) == 0, f"{n}: no identity")


def _positive_real(c, _):
    s = sp.Symbol("s")
    z = sp.Matrix([[_read(e, {"s": s}) for e in row] for row in c["impedance"]])
    one = sp.eye(z.rows)
    wave = ((z - one) * (z + one).inv()).applyfunc(sp.cancel)
    d = sp.Poly(sp.lcm_list([sp.denom(e) for e in wave]), s).monic()
    a, d = dict(enumerate(d.all_coeffs())), d.as_expr()
    for k in range(1, len(a)):  # Hurwitz
        _need(sp.Matrix(k, k, lambda i, j: a.get(2 * j - i + 1, 0)).det() > 0, "S is not stable")
    n = (wave * d).applyfunc(sp.cancel)
    gap = d * d.subs(s, -s) * one - n.subs(s, -s).T * n
    for rows in {1: [[0]], 2: [[0], [1], [0, 1]]}[z.rows]:  # principal minors over omega^2
        p = sp.Poly(sp.expand(gap.extract(rows, rows).det().subs(s, sp.sqrt(-s))), s)
        _need(p.LC() >= 0 and not any(m % 2 and b for (_, b), m in p.intervals(inf=0)), "|S| > 1")


def check(c: dict) -> str:
    """The claim of a certificate (a dict read from JSON); ValueError where it proves nothing."""
    text = json.dumps({k: v for k, v in c.items() if k != "digest"}, sort_keys=True)
    _need(hashlib.sha256(text.encode()).hexdigest() == c["digest"], "changed since it was written")
    for signs in itertools.product((1, -1), repeat=len(c.get("signs", ()))):
        {"storage": _storage, "positive real": _positive_real}[c["kind"]](c, signs)
    return c["claim"]


for file in sys.argv[1:] if __name__ == "__main__" else ():
    print("proved:", check(json.loads(open(file, encoding="utf-8").read())))
