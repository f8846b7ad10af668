"""Theory of hard discs: equations of state, rates, distributions, and forecasts for a scene."""
