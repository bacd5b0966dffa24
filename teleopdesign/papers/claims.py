"""Statements of the first paper that rest on its experiments and users: P24 to P26."""

from ._statement import BERNSTEIN, claim

two_compensators = claim(
    24,
    paper=BERNSTEIN,
    place="comparison of the two methods",
    words="Motion-based cancellation needs an accurate model, cannot act before motion and "
    "suffers from delay at reversals. Force feedback needs neither model nor motion, and its "
    "roll-off limits it.",
    see=(13, 38, 47, 48),
)
users = claim(
    25,
    paper=BERNSTEIN,
    place="experiments",
    words="Four users felt least friction with the hybrid. The model omits low-velocity detail on "
    "purpose. a and b were tuned by hand. F_C is half the force difference between motion up and "
    "motion down.",
    see=(13,),
)
untested = claim(
    26,
    paper=BERNSTEIN,
    place="text",
    words="Independence of amplitude was not a design goal, and 4 to 20 Hz was not tested.",
    see=(20, 22),
)
