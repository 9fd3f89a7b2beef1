# The five things that people do; each works in an environment with `pip install -e ".[dev]"`.
.PHONY: quick test lint docs ci

quick: ## every room in a minute
	python -m pytest -q -n 2 -m "quick and not slow"

test: ## what the README's test command runs
	python -m pytest -q -n 2 -m "not slow"

lint: ## style, types, spelling
	ruff check .
	ruff format --check .
	mypy
	codespell

docs: ## the site, and its links
	python -m sphinx -q -W -b html docs docs/_build/html
	python docs/check_links.py docs/_build/html

ci: ## all that must hold before a change lands, in fresh environments
	.ci/run
