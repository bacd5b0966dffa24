"""How a design looks: proposals with their reasons, predictions, claims, warnings."""
