"""Searches for designs: evolution over generations, within limits."""
