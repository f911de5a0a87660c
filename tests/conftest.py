"""What holds for every test: no service of a test writes into the user's folders."""

import os

os.environ["IKPLAN_STORE_PATH"] = ":memory:"
