"""The proof of clearance held to coal: its distances, its bounds and its cost."""
