"""Access to the HDF5 file of a log: its chunks, tables, commit record and file consistency flags."""
