"""The HDF5 file beneath a log: chunks, tables, the commit record, and the mark of a writer at work."""
