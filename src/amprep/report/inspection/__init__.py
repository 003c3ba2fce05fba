"""What is in a file, as a record, as JSON, for the terminal, and as a page with pictures."""
