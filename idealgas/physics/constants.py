"""Times that are no times."""

NEVER = 1e300
"""Later than any event; finite, so that sums and comparisons stay ordinary."""
