"""One module per stage, and `run`, which runs them all."""
