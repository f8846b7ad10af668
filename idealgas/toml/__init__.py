"""TOML files: parsing with line numbers, overrides, and error messages, for documents of any model."""
