"""One impairment a file, behind the interface of base.py; registry.py lists them."""
