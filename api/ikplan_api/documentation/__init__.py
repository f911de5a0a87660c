"""What a person reads: the manual of the service and a page for each type of problem."""
