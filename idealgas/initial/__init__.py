"""The discs of a scene as arrays: their state, their placement, and whether they are in static contact."""
