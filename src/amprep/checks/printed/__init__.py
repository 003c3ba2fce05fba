"""Judge what the target of a build file would print."""
