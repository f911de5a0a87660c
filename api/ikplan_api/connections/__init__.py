"""Connections of clients: bounded in number, in all and by address, and in time."""
