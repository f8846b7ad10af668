"""Films and pictures of a log."""
