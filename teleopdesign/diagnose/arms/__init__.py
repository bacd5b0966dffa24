"""Diagnosis of an arm: several joints that share the inertial parameters of its links.

Each joint is diagnosed as a body by itself, with what the other joints know of the links
(`shared_links`); the effects named at one joint sharpen what the others know.
"""

from .diagnosis import ArmDiagnosis, ArmRung
from .ladder import find_missing_in_arm

__all__ = ["ArmDiagnosis", "ArmRung", "find_missing_in_arm"]
