"""Domain decomposition: several threads simulate slabs of one gas, with the same log for any number of threads."""
