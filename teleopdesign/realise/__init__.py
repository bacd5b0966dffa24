"""Any block or diagram in each of its forms, derived from its laws."""
