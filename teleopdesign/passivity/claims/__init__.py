"""Claims with their verdicts: certificates that prove a claim, and motions that refute it."""
