"""What every folder uses and what is no physics: errors, units, TOML, words, whole files."""
