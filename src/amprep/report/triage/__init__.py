"""Sort what a run found by what must be done: must fix, worth a check, supported, self-supporting."""
