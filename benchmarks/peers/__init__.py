"""What users would otherwise use, each library in its own words, on our URDFs.

One file per library. Each imports it where it is used: a peer that is not installed is skipped.
"""
