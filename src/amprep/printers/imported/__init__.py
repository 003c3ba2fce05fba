"""Import printers from the profiles of slicers."""
