"""Results of a study: measures, statistics, effects, sensitivity indices, statements and tables."""
