"""Methods that advance a gas from event to event, and the epochs they run in."""
