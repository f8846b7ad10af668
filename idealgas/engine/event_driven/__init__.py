"""The event-driven method: cells find the neighbours, and a tournament tree finds the next event."""
