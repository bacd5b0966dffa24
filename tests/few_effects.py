"""The effects among which the shipped rod is diagnosed where the catalogue does not matter."""

FEW = ("coulomb", "viscous", "stribeck", "quadratic_drag", "spring", "friction_memory")
