"""How the shapes and pictures of the room are made; `scripts/make_room.py` writes them."""
