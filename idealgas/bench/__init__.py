"""Speed of the engine, and cost of each effect."""
