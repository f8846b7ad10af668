"""How fast the engine is, and what each effect costs."""
