"""Compare the CPU time and the errors of the methods, for several time steps and precisions."""
