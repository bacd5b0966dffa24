"""Symbolic transfer functions and impedances from the wiring of a diagram."""

from typing import TYPE_CHECKING

from ..base.folders import lazy_face

if TYPE_CHECKING:
    from .all_transfers import Transfer as Transfer
    from .all_transfers import Transfers as Transfers
    from .all_transfers import all_transfers as all_transfers
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
    from .transfer_functions import symbol_values as symbol_values
    from .transfer_functions import transfer_function as transfer_function
    from .transfer_functions import transfer_functions as transfer_functions
    from .transfer_functions import with_values as with_values
    from .two_port import convert_convention as convert_convention
    from .two_port import hybrid_from_impedance as hybrid_from_impedance
    from .two_port import impedance_from_hybrid as impedance_from_hybrid
    from .two_port import two_port_functions as two_port_functions

__getattr__, __dir__, __all__ = lazy_face(__name__)
