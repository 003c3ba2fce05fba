"""The command line in a process that ends with the process that started it: ``python -m amprep.cli.owned PID ...``."""

import sys

if __name__ == "__main__":
    from amprep import cli, interruption

    interruption.end_with(int(sys.argv.pop(1)), cli.WRONG)
    cli.main()
