"""How studies look: curves, maps, panels, points, bars. Figures compute nothing."""
