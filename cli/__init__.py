"""The program `idealgas`: one module per command, which translates its arguments into a call of the library."""
