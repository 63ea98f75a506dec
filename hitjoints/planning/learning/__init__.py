"""What many plans teach about the next."""
