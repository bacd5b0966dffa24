"""An expression of a file is read by a whitelist: what is none is refused, at once."""

import pytest
import sympy as sp
from clock import in_time
from security.diagram_file import one_line
from security.hostile import CODE, MARK

from teleopdesign.base.errors import ExperimentError
from teleopdesign.diagrams.expressions import read_expression

EXPRESSIONS = (
    *CODE, "().__class__.__bases__[0].__subclasses__()", "x.__class__", "x.diff",
    "getattr(x, 'diff')", "open('/etc/passwd')", "print(1)", "Symbol('x')", "sympify('x')",
    "f'{x}'", "b'x'", "'x' * 9999999", "(x := 1)", "x if x else x", "x and x", "not x", "~x",
    "x @ x", "x // 2", "x % 2", "x << 2", "*x", "x,", "...", "None", "await x", "sin(*x)",
    "sin(x=1)", "sin(**x)", "sin", "sin()", "lambda_(x)", "0x1for x", "1_0if x else 2",
)  # fmt: skip
#: these alone are expressions, of names that are given to nothing
PLAIN = ("sin", f"{MARK}-1", f" {MARK}")
LARGE = (
    "9**9**9**9", "10**10**10", "exp(exp(1e10))", "exp(1e10)", "(1+x)**100000",
    "((((x**64)**64)**64)**64)", "*".join(["x**64"] * 600), "sin(10**4000)",
    "sin(" + "9" * 4000 + ")", "9" * 4400, "1e999", "1e308*1e308", "x*1e308*1e308", "1e-300**-3",
    "(" * 200 + "x" + ")" * 200 + "*" + "sin(" * 70 + "x" + ")" * 70, "(" * 4000 + "x",
    "-" * 9000 + "x", "sin(" * 90 + "x" + ")" * 90, "x" * 10_001, "+".join(["x"] * 4999),
    "(a+b+c+d+e+f+g+h)**64", "*".join(f"(1+a{i})" for i in range(500)),
    "((x*exp(300))**64/x**63)**64", "+".join(f"1/{2 * i + 1}" for i in range(900)),
    "*".join(f"sqrt({10**17 + 7 * i})" for i in range(1, 400)), "cos(" * 58 + "1" + ")" * 58,
    "abs(sqrt(2)-sqrt(" * 20 + "3" + "))" * 20, "1/(x-x)", "0**-1", "tan(pi/2)", "(-8)**(1/3)",
    "asin(2)", "sqrt(-1)", "2**(2**(2**(2**(2**9))))", "factorial(99999)", "gamma(x)", "x**1e9",
    "x**-1000", "0.5**(-5000)", "exp(x)**100",
)  # fmt: skip


@pytest.mark.parametrize("text", EXPRESSIONS, ids=range(len(EXPRESSIONS)))
def test_an_expression_is_refused_where_it_is_none(guard, text):
    with in_time():
        if text in PLAIN:
            (symbol,) = read_expression(text, where="here").free_symbols
            assert symbol.name in text
            return
        with pytest.raises(ExperimentError) as caught:
            read_expression(text, where="here")
    assert one_line(caught.value).startswith("here: ")


@pytest.mark.parametrize("text", LARGE, ids=range(len(LARGE)))
def test_an_expression_that_would_fill_time_or_memory_is_refused_at_once(guard, text):
    with in_time(5), pytest.raises(ExperimentError) as caught:
        read_expression(text, where="here")
    assert len(one_line(caught.value)) < 300


@pytest.mark.slow
def test_what_sympy_would_think_about_for_ever_is_given_up(guard):
    """Found by drawing texts: small, of moderate numbers, and without an end."""
    text = (
        "tan((csc(tan(asin((x/(tan(cot((x+0.5)))-(sqrt((y/64))+((7**64)+csc(1e300))))))))**((pi/"
        "(sin((sin(sec((z-z)))/(tan((pi*x))*(csc(1e300)*(y*z)))))-csc(sec(2))))*atan((x/(asin(("
        "asin((pi+x))/((z+x)+atan(3))))-(((sign(pi)-x)+((pi/3)-(y/y)))*cos(((1e300-0.5)**(x/y))))"
        "))))))"
    )
    with in_time(), pytest.raises(ExperimentError, match="here: .* takes sympy too long to read"):
        read_expression(text, where="here")
    assert read_expression("sqrt(sin(x)**2)", where="here") == sp.Abs(
        sp.sin(sp.Symbol("x", real=True))
    )
