"""Methods that advance a gas from event to event, and the epochs in which they run.

Discs have an index, their place in the arrays of an engine, which changes with every epoch, and an id, which does not.
Times of records count from the start of the epoch; `epoch_start` is that start, counted from the start of the run.
"""
