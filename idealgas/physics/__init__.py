"""The laws of motion and of collisions, one file per law; the functions run compiled or as plain Python.

Lengths, times and masses are in the units of the scene; temperatures are energies (k_B = 1). The argument `disc` is the
stored state of a disc, a NumPy record: position x, y (length), velocity vx, vy (length/time), radius r, mass m, and the
local time t at which the disc has this position and velocity. Local times count from the start of the epoch. The
arguments `disc_id`, `a_id` and `b_id` are ids of discs. If the scene does not have an effect, the argument for that
effect is None.
"""
