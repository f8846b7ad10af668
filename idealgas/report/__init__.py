"""Report of a log: a single HTML page with all applicable analyses and a player of the motion."""
