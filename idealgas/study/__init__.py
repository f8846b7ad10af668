"""Studies that run many simulations: what accuracy costs, sweeps, and how fast the engine is."""
