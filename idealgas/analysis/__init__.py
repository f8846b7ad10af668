"""What is measured from a log, and what theory says of it."""
