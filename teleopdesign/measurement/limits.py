"""Limits that many judgements of a log share: one number for one reason, wherever it is asked."""

SHORTEST = 1.0  # s: least duration of all segments of a record together
FEWEST = 64  # fewest samples of a record, and rows from which a line is fitted first

#: a majority, or what is nearer to one of two readings of a log than to the other
HALF = 0.5
#: part of some rows, steps or changes that is all of them, but for a start from rest, an end, and
#: rounding. Lower: what happens by chance passes for a rule; higher: one odd stretch breaks it
NEARLY_ALL = 0.9
#: part of a quantity that is small beside it, so that it decides nothing: filters, offsets and
#: errors of calibration leave as much
SMALL = 0.1
#: part of a motion by which a body comes back, or its direction varies, where it runs one way:
#: noise of readings, the ends of a low-pass and overshoot at an end make as much. More: a record
#: with one short return counts as one way
ONE_WAY = 0.05
#: times from which something is a rule: once or twice, it may be chance
SEVERAL = 3
