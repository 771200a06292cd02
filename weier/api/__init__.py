"""The calls of programs: `solve`, `fields`, `events`, `find_load` and `Interface`."""
