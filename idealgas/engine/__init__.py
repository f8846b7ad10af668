"""Methods that advance a gas from event to event, and the epochs in which they run.

A disc has an id, which never changes, and an index, its position in the engine's arrays, which may change at the start
of an epoch. The record of a disc is its stored state: position, velocity and time. Times in records are local, counted
from the start of the epoch; `epoch_start` is the time at which the epoch begins, counted from the start of the run.
"""
