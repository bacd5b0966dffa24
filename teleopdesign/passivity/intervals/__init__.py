"""Claims over intervals of a diagram's values: proved over the whole box, refuted, or checked."""
