"""The viewer, headless and in a window."""
