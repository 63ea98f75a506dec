"""What an arm is, and how its description is read."""
