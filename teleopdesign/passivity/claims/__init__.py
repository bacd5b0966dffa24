"""A claim and how it is known: certificates that prove it, motions that refute it, as files."""
