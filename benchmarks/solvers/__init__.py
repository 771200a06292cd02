"""One file for each program compared; a foreign one is imported only where its first solver begins."""
