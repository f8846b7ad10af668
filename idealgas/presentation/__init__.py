"""Tables, names of quantities and the style of figures."""
