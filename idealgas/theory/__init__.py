"""Theory of the gas as pure formulas; no log is read here."""
