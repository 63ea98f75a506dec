"""Which joint hits, in which configuration: postures, plans, and the evidence for them."""
