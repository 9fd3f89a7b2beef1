"""From figures and measurements to laws, engine-free."""
