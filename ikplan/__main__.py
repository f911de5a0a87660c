"""``python -m ikplan``: the same as the command ``ikplan``."""

import sys

from ikplan.cli import main

if __name__ == "__main__":
    sys.exit(main())
