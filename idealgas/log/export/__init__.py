"""Logs as files that other programs read."""
