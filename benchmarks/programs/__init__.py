"""Whether what leaves the product runs on the controller it is for: programs and samples played."""
