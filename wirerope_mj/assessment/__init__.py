"""Results against limits: criteria and their verdicts, and the selection of isolators by them.

Uses responses of the engine; no picture and no page is made here.
"""
