"""Lower bounds on the number of builds and upper bounds on the value."""
