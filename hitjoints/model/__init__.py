"""What a robot is made of: its collision shapes and their meshes."""
