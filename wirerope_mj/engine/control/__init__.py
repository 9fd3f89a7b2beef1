"""The control callback: where the forces of all mounts are made, natively or in Python."""

from wirerope_mj.engine.control.install import installed
