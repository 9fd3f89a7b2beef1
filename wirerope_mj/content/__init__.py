"""Contents of results: statements, tables, charts and scenes in SI, with stable ids, which every renderer shows."""
