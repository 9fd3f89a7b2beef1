"""Vendors' tables of parts and data sheets, and isolators fitted to them."""

from wirerope_mj.mounts.vendor_parts.parts import (
    VendorPart,
    catalogue,
    find_isolator,
    load_isolator,
    shipped_file,
    vendor_parts,
)
