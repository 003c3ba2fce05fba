"""What `amprep slice` wrote."""
