"""Exact event-driven simulation of a two-dimensional gas of hard discs, with every event on record."""

__version__ = "0.1.0"
