"""The command `wirerope`."""

from wirerope_mj.cli.app import main
