"""Adapters for other packages, which each module imports when it needs them.

- adapters.ipctk: IPC Toolkit.
- adapters.mujoco: contacts of the real meshes of MuJoCo models.
- adapters.newton: lists of self-contacts for Newton.
- adapters.trimesh_manager: the methods of trimesh's CollisionManager.
- adapters.urdf: robots from URDF files.
"""
