"""Domain decomposition: several threads simulate slabs of one gas; the log is the same for any number of threads."""
