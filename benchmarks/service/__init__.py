"""How the service stands up: overhead, load, overload and faults, over real sockets."""
