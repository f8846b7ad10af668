"""The laws of motion and of collisions, one file a law: pure functions that compiled and plain Python share."""
