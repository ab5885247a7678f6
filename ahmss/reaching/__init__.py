"""Reaching: where the trunk, the arm and the hand go so that a palm comes to a place in the world."""
