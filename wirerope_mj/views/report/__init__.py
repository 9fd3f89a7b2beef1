"""Reports: a finished run as one page that can be handed over, and as a PDF of it."""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
