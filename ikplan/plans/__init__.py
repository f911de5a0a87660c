"""What is made of a plan: the plan itself, its files and figures, and playback."""
