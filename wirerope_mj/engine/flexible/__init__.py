"""Decks that bend between the base and the mounts: a panel of one mode, in a model of any."""

from wirerope_mj.engine.flexible.panel import Panel as Panel
from wirerope_mj.engine.flexible.panel import panel_of_phrase as panel_of_phrase
