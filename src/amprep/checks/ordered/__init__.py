"""Judge the claims of a build file: whether its settings are weaker than usual, and whether it is what was ordered."""
