"""Pictures of the world: window, headless recorder, contact sheets."""
