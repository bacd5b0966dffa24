"""Linear claims: one family with all its states, its conditions, their signs over a box."""
