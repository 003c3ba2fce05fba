"""Lets ``python -m amprep`` start the command line."""

from amprep.cli import main

if __name__ == "__main__":
    main()
