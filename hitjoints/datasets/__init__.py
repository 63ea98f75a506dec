"""Results as xarray data sets: units, origin, files."""
