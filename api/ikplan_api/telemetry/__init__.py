"""What the service reports of itself: log records, metrics and figures of plans."""
