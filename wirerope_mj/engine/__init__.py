"""The dynamics of a model in MuJoCo: a system and the callback that makes its mounts' forces, statics, simulation, response.

Uses mounts and motions; only this wing and `dynamics` import mujoco.
"""
