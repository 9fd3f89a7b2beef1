"""Vendors' tables of parts and data sheets, and isolators fitted to them."""

from wirerope_mj.mounts.vendor_parts.part_fit import fit_part as fit_part
from wirerope_mj.mounts.vendor_parts.parts import VendorPart as VendorPart
from wirerope_mj.mounts.vendor_parts.parts import vendor_parts as vendor_parts
from wirerope_mj.mounts.vendor_parts.shipped import shipped_file as shipped_file
