"""How well and how fast joint paths are chosen and followed."""
