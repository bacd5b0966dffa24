"""Names of what the loop of a simulation takes and returns, in its order."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Layout:
    """Order of everything that the loop takes and returns, as names.

    columns: of a row of the result;  exponential: states stepped exactly in their affine part, the
    last ones among the states
    """

    states: tuple[str, ...]
    computer_states: tuple[str, ...]
    inputs: tuple[str, ...]
    sampled_inputs: tuple[str, ...]
    commands: tuple[str, ...]
    late: tuple[str, ...]
    parameters: tuple[str, ...]
    columns: tuple[str, ...]
    exponential: tuple[str, ...]
