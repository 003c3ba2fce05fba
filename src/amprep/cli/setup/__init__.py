"""Commands that help to begin: new job files, the demo, and what is installed."""
