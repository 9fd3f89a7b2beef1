"""What the table of a study says: distributions, chances, influences, the worst variants."""
