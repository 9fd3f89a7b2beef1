"""Results as pictures, recordings and pages: the only importers of matplotlib, rerun, jinja2, resvg, python-docx and typst.

Uses every wing below; computes nothing that a user would quote.
"""
