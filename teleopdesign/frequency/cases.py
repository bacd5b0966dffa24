"""One diagram, or several by case."""

from __future__ import annotations

from collections.abc import Mapping

from ..base.errors import ModelError
from ..diagrams import Diagram


def cases_of(diagrams: Diagram | Mapping[str, Diagram]) -> dict[str, Diagram]:
    """Case -> diagram; a single diagram has its name as case. Raises ModelError: no diagram."""
    if isinstance(diagrams, Diagram):
        return {diagrams.name: diagrams}
    if not diagrams:
        raise ModelError("diagrams: found none, expected a diagram, or several by case")
    return dict(diagrams)
