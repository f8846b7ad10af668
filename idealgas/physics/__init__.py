"""The laws of motion and of collisions, one file per law: pure functions, the same in compiled and in plain Python.

Lengths, times and masses are in the units of the scene; temperatures are energies, k_B = 1. A `disc` is a record:
position x, y (length), velocity vx, vy (length/time), radius r, mass m, all at its local time t, which counts from the
start of the epoch. `own`, `a_id` and `b_id` are ids of discs. The argument of an effect that a scene does not have is
None.
"""
