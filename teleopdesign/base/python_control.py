"""All that the package takes from python-control: what another version of it may change is here.

Imported where it is used, never at the head of a module: python-control loads slowly.
"""

from control import (
    FRD,
    LTI,
    FrequencyResponseData,
    InputOutputSystem,
    InterconnectedSystem,
    NonlinearIOSystem,
    StateSpace,
    TransferFunction,
    feedback,
    frd,
    interconnect,
    nlsys,
    pade,
    ss,
    tf,
)

__all__ = [
    "FRD",
    "LTI",
    "FrequencyResponseData",
    "InputOutputSystem",
    "InterconnectedSystem",
    "NonlinearIOSystem",
    "StateSpace",
    "TransferFunction",
    "feedback",
    "frd",
    "interconnect",
    "nlsys",
    "pade",
    "ss",
    "tf",
]
