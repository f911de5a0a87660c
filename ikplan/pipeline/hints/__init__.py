"""What takes time and need not, in words."""
