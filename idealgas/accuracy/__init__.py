"""CPU time and errors of the methods, by time step and by precision."""
