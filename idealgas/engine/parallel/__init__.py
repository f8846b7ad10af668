"""Several threads for one gas: the box is decomposed into slabs, with one log whatever their number."""
