"""The typed settings of a job."""
