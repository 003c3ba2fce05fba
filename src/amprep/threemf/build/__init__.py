"""Build jobs: the record in a 3MF file, and reading it back."""
