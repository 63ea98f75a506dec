"""What happens at the impact: Eq. 1-4, 10, 11."""
