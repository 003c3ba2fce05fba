"""Build files: amprep's metadata in them, and reading them back."""
