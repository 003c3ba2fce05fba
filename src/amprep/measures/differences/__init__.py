"""In what two builds differ."""
