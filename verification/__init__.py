"""External checks of wirerope_mj that stay: `python -m verification` from the root of a checkout.

Every case sets a result of the library beside one that was made without it: another program, an own integration of the
equations of motion, a closed form, or a published value. `docs/verification.md` is written by the same command.
"""
