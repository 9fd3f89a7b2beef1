"""How many examples tests of properties draw, and from where: the same in every run, or, by hand and once a week, others.

    python -m pytest --hypothesis-profile=random --hypothesis-seed=SEED -k "..."

draws ten times as many at random. Neither profile looks at the clock.
"""

from hypothesis import HealthCheck, settings

_TIMELESS = {"deadline": None, "suppress_health_check": [HealthCheck.too_slow], "print_blob": True}
_USUAL, _MANY = 100, 1000
settings.register_profile("repeatable", derandomize=True, max_examples=_USUAL, **_TIMELESS)
settings.register_profile("random", max_examples=_MANY, **_TIMELESS)
settings.load_profile("repeatable")


def examples(number):
    """Set how many examples a test draws in the repeatable profile."""
    return settings(max_examples=number * settings.default.max_examples // _USUAL)
