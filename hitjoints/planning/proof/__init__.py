"""What is proved about a plan, or about there being none."""
