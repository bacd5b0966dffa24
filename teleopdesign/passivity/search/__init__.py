"""Search for motions that release energy: strokes by simulation, and growing waves."""
