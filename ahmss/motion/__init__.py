"""Motions as arrays over frames: the clip file, resampling, ground contact, and measures of quality."""
