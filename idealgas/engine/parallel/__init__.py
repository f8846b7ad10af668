"""Several threads for one gas: domain decomposition into slabs, with the same log for any number of threads."""
