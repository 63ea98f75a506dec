"""Sweeps over configurations and workspaces, as xarray data sets with units."""
