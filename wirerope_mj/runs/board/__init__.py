"""The drawing board: tables and a job that are edited, and what becomes of the model meanwhile."""
