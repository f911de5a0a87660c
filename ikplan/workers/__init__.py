"""Worker processes of batches and of the service."""
