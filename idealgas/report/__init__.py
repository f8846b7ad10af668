"""The report of a log: a single HTML page with every applicable analysis and a player of the motion."""
