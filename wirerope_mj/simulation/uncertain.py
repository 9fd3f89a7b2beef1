"""Warnings about a response that is less certain than its digits."""

import warnings

from wirerope_mj.errors import AccuracyWarning
from wirerope_mj.response import Response


def warn_of_uncertainty(response: Response) -> None:
    """Warn where stops were struck, and where the estimated error is above the accuracy that was asked for."""
    numerics, contacts = response.numerics, response.peaks.contacts or {}
    for of_mounts, things in ((False, "contact pairs"), (True, "stops")):
        alike = [name for name, contact in contacts.items() if bool(contact.mount) is of_mounts]
        struck = [name for name in response.peaks.struck if name in alike]
        if struck:
            warnings.warn(
                f"{len(struck)} of {len(alike)} {things} were struck, first {contacts[struck[0]].called(struck[0])} at "
                f"{contacts[struck[0]].first_touch:.4f} s: from there on accelerations are only as good as "
                "what is known of the stops' stiffness and damping.",
                AccuracyWarning,
                stacklevel=3,
            )
    if numerics.error_estimate > numerics.accuracy:
        warnings.warn(
            f"the estimated error, {numerics.error_estimate:.1e} of the peaks, is above the accuracy asked for, "
            f"{numerics.accuracy:.1e}: the step of {1e3 * numerics.timestep:.4g} ms is limited by {numerics.limited_by}. "
            "Ask for less (a larger `accuracy`), or give a smaller `timestep`.",
            AccuracyWarning,
            stacklevel=3,
        )
