"""The event-driven method: cells find the neighbours, a tournament tree finds the next event."""
