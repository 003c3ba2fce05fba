"""What a slicer runs with each file of G-code that it exports."""
