"""Error over time of every feature, on one page: see run.py."""
