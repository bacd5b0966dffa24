"""An evaluator of certificates that shares nothing with their checker.

Python's syntax tree, and random exact values that meet what the statement assumes.
"""

import ast
import math
import operator
from fractions import Fraction


class Dual:
    """A fraction with its rate of change."""

    def __init__(self, value, slope=0):
        self.value, self.slope = Fraction(value), Fraction(slope)

    def __add__(self, other):
        return Dual(self.value + other.value, self.slope + other.slope)

    def __sub__(self, other):
        return Dual(self.value - other.value, self.slope - other.slope)

    def __mul__(self, other):
        slope = self.slope * other.value + self.value * other.slope
        return Dual(self.value * other.value, slope)

    def __truediv__(self, other):
        value = self.value / other.value
        if not other.value:
            raise ZeroDivisionError
        return Dual(value, (self.slope - value * other.slope) / other.value)


_BINARY = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
}


def evaluated(text, values):
    """By Python's syntax tree; values: name -> Dual, or complex numbers."""
    number = Dual if all(isinstance(v, Dual) for v in values.values()) else complex

    def walk(node):
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return number(node.value)
        if isinstance(node, ast.Name):
            return values[node.id]
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return number(0) - walk(node.operand)
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Pow):
            power, base = ast.literal_eval(node.right), walk(node.left)
            result = number(1)
            for _ in range(abs(power)):
                result = result * base
            return result if power >= 0 else number(1) / result
        assert isinstance(node, ast.BinOp), ast.dump(node)
        return _BINARY[type(node.op)](walk(node.left), walk(node.right))

    return walk(ast.parse(text.strip(), mode="eval").body)


def falsified(c, rng, tries=60):
    """What is wrong with a certificate, by trying values; None where nothing was found."""
    return _impedance_falsified(c, rng) if "impedance" in c else _storage_falsified(c, rng, tries)


def _impedance_falsified(c, rng):
    for _ in range(1000):
        size, angle = 10 ** rng.uniform(-4, 4), math.pi / 2 - 10 ** rng.uniform(-4, 0)
        at = {"s": complex(size * math.cos(angle), size * math.sin(angle))}
        z = [[evaluated(e, at) for e in row] for row in c["impedance"]]
        x = [complex(rng.gauss(0, 1), rng.gauss(0, 1)) for _ in z]
        power = sum(x[i].conjugate() * z[i][j] * x[j] for i in range(len(z)) for j in range(len(z)))
        scale = sum(abs(e) for row in z for e in row) * sum(abs(e) ** 2 for e in x)
        if power.real < -1e-9 * scale:  # rounding of a handful of double operations
            return f"Re Z < 0 at {at}"
    return None


def _storage_falsified(c, rng, tries):
    states, fixed = list(c["rates"]), {*c["rates"], *c["constants"]}
    names = [*c["constants"], *c["signals"], *states]
    example = {n: Fraction(c["example"].get(n, "0")) for n in names}

    def values(base, slopes=None, signs=None):
        point = {n: Dual(x, (slopes or {}).get(n, 0)) for n, x in base.items()}
        for x in c["signs"]:
            s = (signs or {}).get(x) or (1 if base[x] >= 0 else -1)
            point["sign_" + x], point["abs_" + x] = Dual(s), Dual(s) * point[x]
        return point

    def at(text, *arguments):
        return evaluated(text, values(*arguments))

    def allowed(base):
        return (
            all(at(e, base).value > 0 for e in c["positive"].values())
            and all(at(e, base).value >= 0 for e in c["nonnegative"].values())
            and all(at(h["expression"], base).value >= 0 for h in c["invariant"].values())
        )

    rest = example | {x: Fraction(0) for x in (*states, *c["signs"])}
    if not allowed(example) or not allowed(rest) or at(c["storage"], rest).value != 0:
        return "the example or rest does not meet what is assumed"
    inner = [c["storage"], *(h["expression"] for h in c["invariant"].values())]
    for _ in range(tries):
        base = {n: _varied(x, rng) for n, x in example.items()}
        if not allowed(base):
            base = example | {n: base[n] for n in rng.sample(names, min(len(names), 2))}
        if not allowed(base):
            continue
        other = {n: x if n in fixed else _varied(x, rng) for n, x in base.items()}
        if any(at(e, base).value != at(e, other).value for e in inner):
            return "V or h moves with a signal"
        for x in c["signs"]:
            level = base | {x: Fraction(0)}
            sides = [[at(e, level, None, {x: s}).value for e in inner] for s in (1, -1)]
            if sides[0] != sides[1]:
                return f"V or h jumps at {x} = 0"
        slopes = {x: at(e, base).value for x, e in c["rates"].items()}
        stored = at(c["storage"], base, slopes)
        if stored.value < 0 or at(c["supply"], base).value < stored.slope:
            return f"V < 0 or V' > supply at {base}"
        for h in c["invariant"].values():
            kept = at(h["expression"], base, slopes)
            if kept.slope + at(h["rate"], base).value * kept.value < 0:
                return f"an invariant is not kept at {base}"
    return None


def _varied(x, rng):
    if rng.random() < 0.3:
        return x
    if rng.random() < 0.5:
        return x * Fraction(rng.randint(1, 40), 10)
    return Fraction(rng.randint(-300, 300), rng.choice((1, 7, 100)))
