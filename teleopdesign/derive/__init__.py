"""Symbolic transfer functions and impedances from the wiring of a diagram."""

from ..base.arguments import check_arguments
from .all_transfers import Transfer, Transfers, all_transfers
from .conventions import convert_convention, hybrid_from_impedance, impedance_from_hybrid
from .elimination import has_actuation, transfer
from .noncommutative import counterexample, insert_matrices, proved_equal
from .printing import as_latex, as_text, block_symbol
from .transfer_functions import (
    TransferFunctions,
    return_difference,
    transfer_functions,
)
from .two_port import two_port_functions
from .with_values import symbol_values, transfer_function, with_values

__all__ = [
    "Transfer",
    "TransferFunctions",
    "Transfers",
    "all_transfers",
    "as_latex",
    "as_text",
    "block_symbol",
    "counterexample",
    "has_actuation",
    "hybrid_from_impedance",
    "impedance_from_hybrid",
    "convert_convention",
    "insert_matrices",
    "proved_equal",
    "return_difference",
    "symbol_values",
    "transfer",
    "transfer_function",
    "transfer_functions",
    "two_port_functions",
    "with_values",
]

check_arguments(globals(), __all__)
