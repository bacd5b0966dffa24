"""How diagnoses and comparisons look."""

from .figures import arm_diagnosis as arm_diagnosis
from .figures import diagnosis as diagnosis
