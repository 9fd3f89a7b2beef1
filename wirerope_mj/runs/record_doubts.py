"""What is doubtful about the measured records of a run, as its report and its summary say it."""

import warnings

from wirerope_mj.foundation.errors import RecordWarning
from wirerope_mj.motions import BaseMotion, Record, load_record


def record_doubts(motion: BaseMotion) -> tuple[str, ...]:
    """Return what is said when the records in a motion are read, each once, with their names instead of their paths.

    They are read again for it, as a warning is given once and a record does not keep it: what is found in a run's folder
    later is what was said when it was simulated.
    """
    found: dict[str, None] = {}
    for record in motion.parts:
        if not isinstance(record, Record):
            continue
        arguments = {name: value for name, value in record.to_dict().items() if name != "kind"}
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always", RecordWarning)
            load_record(**arguments)
        words = (str(one.message) for one in said if issubclass(one.category, RecordWarning))
        found |= dict.fromkeys(text.replace(str(record.path), record.path.name) for text in words)
    return tuple(found)
