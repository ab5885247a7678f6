"""`python -m ahmss`: the same as the command `ahmss`."""

from ahmss.cli import main

if __name__ == "__main__":
    main()
