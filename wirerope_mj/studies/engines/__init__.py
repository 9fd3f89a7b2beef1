"""Who computes the variants of a study: processes of this machine, or the workers of a cluster."""
