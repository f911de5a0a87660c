"""From what people have of a robot to what a description needs: files, tip, home, limits."""
