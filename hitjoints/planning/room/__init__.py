"""The room around an arm: shapes, clearance, table and object."""
