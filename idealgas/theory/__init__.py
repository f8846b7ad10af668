"""Theory of the gas, by formulas alone: no log is read here."""
