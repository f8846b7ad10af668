"""Common parts of all analyses: reading a log in blocks, windows of time, statistics, tables and style of figures."""
