"""The request that a command line makes: of a file, of options, for a robot."""
