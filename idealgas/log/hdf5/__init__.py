"""The HDF5 file of a log: chunks, tables, the commit record, and the file consistency flags."""
