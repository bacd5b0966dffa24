"""Names of the arguments and results of a simulation loop, in its order."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Layout:
    """Order of all arguments and results of the loop, as names.

    columns: of a row of the result
    exponential: hidden states whose affine part is integrated exactly; they are the last states
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
