"""The shipped algorithms, in-process and as processes."""
