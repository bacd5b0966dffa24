"""Motions that give out energy, sought: along strokes by simulation, and as growing waves."""
