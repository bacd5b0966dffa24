"""Statements of the first paper that rest on its experiments and users: P24 to P26."""

from ._statement import BERNSTEIN, claim

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
