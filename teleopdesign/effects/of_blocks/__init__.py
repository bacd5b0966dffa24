"""Effects of a hand or an environment, one file each; none is a candidate of a diagnosis."""
