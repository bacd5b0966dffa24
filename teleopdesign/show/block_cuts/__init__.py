"""How a whole diagram's comparison is worded and drawn."""
