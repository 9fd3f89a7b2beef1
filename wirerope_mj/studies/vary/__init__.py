"""Inputs of a study: distributions, quantities, samples, and the variants made of them."""
