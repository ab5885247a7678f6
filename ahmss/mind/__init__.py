"""A language model as the mind of a human: a server of the Model Context Protocol over a main's port."""
