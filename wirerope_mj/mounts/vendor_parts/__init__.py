"""Vendors' tables of parts and data sheets, and isolators fitted to them."""

from wirerope_mj.mounts.vendor_parts.by_name import catalogue as catalogue
from wirerope_mj.mounts.vendor_parts.by_name import find_isolator as find_isolator
from wirerope_mj.mounts.vendor_parts.by_name import load_isolator as load_isolator
from wirerope_mj.mounts.vendor_parts.by_name import shipped_file as shipped_file
from wirerope_mj.mounts.vendor_parts.parts import VendorPart as VendorPart
from wirerope_mj.mounts.vendor_parts.parts import vendor_parts as vendor_parts
