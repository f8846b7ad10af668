"""Methods that advance a gas from event to event, and the epochs in which they run.

A disc has an id, which never changes, and an index, its position in the engine's arrays, which changes with every
epoch. Times in records are local: they count from the start of the epoch. `epoch_start` is the time of that start,
counted from the start of the run.
"""
