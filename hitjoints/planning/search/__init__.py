"""From samples to optima."""
