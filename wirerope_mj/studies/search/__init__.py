"""Searches: designs made better generation by generation, within limits."""
