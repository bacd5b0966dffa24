"""How an unexplained residual looks: sentences, findings, views."""
