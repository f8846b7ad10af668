"""The command `idealgas`: one module per command, each translating arguments into one library call."""
