"""Systems through one time grid by the kernel, eight to a vector, on several threads."""
