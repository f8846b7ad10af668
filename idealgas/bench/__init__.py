"""Measure the speed of the engine and the cost of each effect."""
