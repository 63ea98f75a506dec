"""Data sets and what is written from them: units, files, whole or not at all."""
