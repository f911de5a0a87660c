"""What a command says on a terminal: answers, progress, notes, failures."""
