"""How responses over frequency look: Bode and Nyquist plots, impedances, loop gains."""
