"""What accuracy costs in time, by methods, steps and digits."""
