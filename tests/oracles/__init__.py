"""Judges that share nothing with what they judge; the benchmarks count with them, too."""
