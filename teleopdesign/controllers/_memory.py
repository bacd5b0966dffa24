"""Values that laws in a computer keep from one sample to the next."""

from sympy import S


def store_input(now, p):
    """The input, for the next sample."""
    return now.input


def zero_rate(now, p):
    """Rate 0: in continuous time there is no last sample."""
    return S.Zero
