"""ikplan beside other libraries, in one process."""
