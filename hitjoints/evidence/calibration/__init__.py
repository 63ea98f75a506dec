"""What past hits tell about the next: from landings to an object's numbers."""
