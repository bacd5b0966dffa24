"""How a proposed experiment looks: sentences, findings, figure."""
