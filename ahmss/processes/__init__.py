"""How main starts algorithm processes, asks them for frames, watches them, and ends them."""
