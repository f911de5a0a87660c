"""How many of the descriptions that people have load without a question, and plan."""
