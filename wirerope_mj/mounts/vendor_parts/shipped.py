"""Parts of the vendors' tables that ship as isolator files."""

from wirerope_mj.foundation.resources import catalogue_folder
from wirerope_mj.mounts.vendor_parts.parts import VendorPart, vendor_parts


def shipped_file(part: VendorPart) -> str | None:
    """Return the name of the isolator file of a part, as `socitec_cb1400_30`; None where none ships, as for fewer loops."""
    if part not in vendor_parts():
        return None
    ending = "_" + part.name.lower().replace("-", "_")
    return next((path.stem for path in catalogue_folder().glob("*.toml") if path.stem.endswith(ending)), None)
