"""What the analyses share: streams over a log, windows, statistics, tables and the style of pictures."""
