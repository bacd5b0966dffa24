"""Symbolic transfer functions and impedances from the wiring of a diagram."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .all_transfers import Transfer as Transfer
    from .all_transfers import Transfers as Transfers
    from .all_transfers import all_transfers as all_transfers
    from .conventions import convert_convention as convert_convention
    from .conventions import hybrid_from_impedance as hybrid_from_impedance
    from .conventions import impedance_from_hybrid as impedance_from_hybrid
    from .elimination import has_actuation as has_actuation
    from .elimination import transfer as transfer
    from .noncommutative import counterexample as counterexample
    from .noncommutative import insert_matrices as insert_matrices
    from .noncommutative import proved_equal as proved_equal
    from .printing import as_latex as as_latex
    from .printing import as_text as as_text
    from .printing import block_symbol as block_symbol
    from .transfer_functions import TransferFunctions as TransferFunctions
    from .transfer_functions import return_difference as return_difference
    from .transfer_functions import transfer_functions as transfer_functions
    from .two_port import two_port_functions as two_port_functions
    from .with_values import symbol_values as symbol_values
    from .with_values import transfer_function as transfer_function
    from .with_values import with_values as with_values

__getattr__, __dir__, __all__ = lazy_face(__name__)
