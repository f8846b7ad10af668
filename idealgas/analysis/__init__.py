"""Measurements from event logs, each compared with theory."""
