"""Frequencies and periodic motions of a system: modes, sweeps, periodic orbits and their branches, harmonic balance.

Uses the engine.
"""
