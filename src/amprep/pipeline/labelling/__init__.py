"""Labels on the parts of a job."""
