"""How diagnoses and comparisons look."""

from ..figures import diagnosis as diagnosis
