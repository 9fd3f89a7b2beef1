"""Documents: a result on pages that are filed and signed, as PDF and DOCX."""

from lazy_loader import attach_stub

__getattr__, __dir__, __all__ = attach_stub(__name__, __file__)
