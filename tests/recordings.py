"""Reads a recording back: its entities and their columns."""


def entities(path) -> dict[str, list]:
    from rerun.chunk import RrdReader

    found: dict[str, list] = {}
    for chunk in RrdReader(str(path)).stream():
        found.setdefault(str(chunk.entity_path), []).append(chunk.to_record_batch())
    return found


def column(batches, name):
    return next(batch[name] for batch in batches if name in batch.schema.names)
