"""Many jobs: a queue that runs each of them in a process of its own, on this machine or on a cluster."""
