"""Theorems about friction, its cancellation and computers: one file each."""
