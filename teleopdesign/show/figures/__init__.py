"""Figures of results; nothing is computed here."""
