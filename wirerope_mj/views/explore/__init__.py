"""The page of a what-if: sliders, verdict and curves in a browser of this machine, beside the viewer of recordings.

Nothing of it leaves the machine: the server answers 127.0.0.1 alone, and the page's policy lets the browser load from nowhere
else. Sliders and simulations are handed in by `wirerope_mj.runs.explore`.
"""
