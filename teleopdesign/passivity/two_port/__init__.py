"""Two-ports: passivity and absolute stability, and motions that grow between terminations."""
