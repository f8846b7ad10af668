"""Reading of TOML files with line numbers, overrides, and error messages; independent of scenes."""
