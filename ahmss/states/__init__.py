"""States of objects, what shows of them and what follows from them: read from files, kept by the server, drawn."""
