"""Estimates with standard errors from series of numbers."""
