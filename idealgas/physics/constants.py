"""Constants shared by all laws."""

NEVER = 1e300
"""Time of an event that does not happen: after all events, but finite, so that sums and comparisons stay ordinary."""
