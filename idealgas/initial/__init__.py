"""The initial discs of a scene as arrays: their state, their placement, and checks for static contact."""
