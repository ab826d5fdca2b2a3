"""Crumple within other packages: adapters.ipctk and adapters.newton, each of which imports what it is for."""
