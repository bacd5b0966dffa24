"""Linear ports: impedances, the positive-real test and storage functions."""
