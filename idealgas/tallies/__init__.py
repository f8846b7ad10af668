"""Sums over the flights and collisions in a log, and the windows of time that they are taken in."""
