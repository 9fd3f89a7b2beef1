"""Vendors' tables of parts and data sheets, and isolators fitted to them."""

from wirerope_mj.mounts.vendor_parts.by_name import catalogue, find_isolator, load_isolator, shipped_file
from wirerope_mj.mounts.vendor_parts.parts import VendorPart, vendor_parts
