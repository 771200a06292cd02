"""One file for each program compared; foreign ones are imported only when they are asked to begin."""
