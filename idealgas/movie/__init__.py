"""Films of a log, frame by frame."""
