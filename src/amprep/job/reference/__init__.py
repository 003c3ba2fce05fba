"""What every key of a job file means: read from the page about job files, for editors and for new job files."""
