"""What is maximised over which configurations."""
