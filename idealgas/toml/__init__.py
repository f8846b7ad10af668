"""A TOML text with its line numbers: reading, overrides, messages about what is wrong; it knows no gas."""
