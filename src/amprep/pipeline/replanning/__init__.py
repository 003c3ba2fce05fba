"""Plan a build again after its parts were moved, turned, deleted, copied or added in another program."""
