"""Adapters for other packages, which each module imports when it needs them.

- adapters.ipctk: IPC Toolkit.
- adapters.newton: lists of self-contacts for Newton.
- adapters.urdf: robots from URDF files.
"""
