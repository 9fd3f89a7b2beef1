"""What every wing stands on: errors, units, checks of arguments, files written whole, compiled kernels, shipped files.

Imports nothing else of the package.
"""
