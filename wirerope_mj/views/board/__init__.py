"""The page of the drawing board: what it draws, its columns, and the server that hands it out."""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
