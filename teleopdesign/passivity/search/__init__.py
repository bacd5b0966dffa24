"""Motions that release energy, sought: along strokes by simulation, and as growing waves."""
