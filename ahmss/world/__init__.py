"""The virtual space: its schema, its server, the client that mains and viewers use, recordings."""
