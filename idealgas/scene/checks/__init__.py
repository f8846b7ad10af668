"""What is wrong with a scene: faults between its tables."""
