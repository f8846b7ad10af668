"""Simulation of one gas by several threads: domain decomposition into slabs, with the same log for any number."""
