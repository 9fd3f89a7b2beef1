"""What varies in a study, and how: distributions, quantities, samples, and the variants made of them."""
