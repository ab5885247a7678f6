"""Parts of make_motions.py: a poser for standing bodies, and the motions made with it."""
