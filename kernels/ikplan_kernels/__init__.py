"""The compiled kernels of ikplan, which finds them beside this file."""
