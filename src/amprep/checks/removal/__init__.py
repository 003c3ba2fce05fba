"""Judge whether supports can be removed: powder can leave them, and their contacts can be reached."""
