"""The event-driven method: neighbours are found with cells, and the next event with a tournament tree."""
