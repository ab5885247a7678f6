"""Motion capture: trackers on serial lines and over UDP, a simulated tracker, calibration, and clips made of takes."""
