"""From A to B: what a hit does to a box on a table, and where the box comes to rest."""
