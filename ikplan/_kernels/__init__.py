"""Where compiled functions are kept and found; what they are is the business of ``ikplan._jit``."""
