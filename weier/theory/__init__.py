"""Physics in closed form: the half-plane, bounds, conduction, and the rough punch of Borodich and Galanov."""
