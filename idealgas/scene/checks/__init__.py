"""What is wrong with a scene, one file a table."""
