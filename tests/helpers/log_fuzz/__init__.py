"""Crafted logs: sound ones with wrong values, texts or headers and correct checksums, read by every command.

`editor` has the sound logs and changes them; `values`, `texts` and `headers` are the changes; `commands` are taken
from the program; `judge` decides whether a command did right.
"""
