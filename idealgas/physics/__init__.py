"""The laws of motion and of collisions, one file per law: pure functions that run compiled or as plain Python.

Lengths, times and masses are in the units of the scene; temperatures are energies (k_B = 1). A `disc` is a record with
the position x, y (length), velocity vx, vy (length/time), radius r and mass m of a disc at the local time t of the
record, which counts from the start of the epoch. `disc_id`, `a_id` and `b_id` are ids of discs. If the scene does not
have an effect, the argument for that effect is None.
"""
