"""A log as one page with every analysis that applies."""
