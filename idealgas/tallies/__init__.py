"""Sums over the flights and collisions in a log, and the windows of time over which they are taken."""
