"""Shock and vibration of equipment and floors on wire-rope isolators."""
