"""The whole of a wish: joint, motion, where the object ends, and a verdict."""
