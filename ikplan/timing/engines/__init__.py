"""The engines that time a path: toppra, and a compiled one."""
