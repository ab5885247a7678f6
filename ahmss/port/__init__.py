"""The port of a main process: what a human model outside asks, and what it is answered."""
