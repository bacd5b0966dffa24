"""Linear one-ports: impedances, the positive-real test and storage functions."""
