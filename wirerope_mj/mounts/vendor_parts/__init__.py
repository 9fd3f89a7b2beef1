"""Tables of the makers' parts as they are printed, and an isolator fitted to a row of them."""

from wirerope_mj.mounts.vendor_parts.fitted import fit_part as fit_part
from wirerope_mj.mounts.vendor_parts.parts import Part as Part
from wirerope_mj.mounts.vendor_parts.parts import vendor_parts as vendor_parts
