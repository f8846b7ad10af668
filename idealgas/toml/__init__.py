"""Read TOML files with line numbers, apply overrides, and format error messages; independent of scenes."""
