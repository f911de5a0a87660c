"""Commands that map: which poses a robot reaches, and where it is best placed."""
