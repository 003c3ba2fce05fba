"""Commands that take a job or parts."""
