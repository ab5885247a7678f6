"""The human body as arrays: links, quaternions, kinematics, blending. Arrays in, arrays out, no input or output."""
