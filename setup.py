"""The packages: those found, and two that lie beside `hitjoints` and are installed inside it."""

from setuptools import find_packages, setup

setup(packages=[*find_packages(include=["hitjoints*"]), "hitjoints.cli", "hitjoints.robots"])
