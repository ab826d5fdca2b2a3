"""Adapters for other packages: adapters.ipctk, which imports ipctk, and adapters.newton."""
