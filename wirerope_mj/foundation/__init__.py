"""Foundation of all wings: errors, units, checks of arguments, atomic files, CSV with units, compiled kernels, shipped files.

Imports nothing else of the package.
"""
