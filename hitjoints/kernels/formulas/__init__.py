"""The maths of an arm, written once over abstract numbers."""
