"""Print profiles of slicers: where they are, and how a script to run after slicing is written into them."""
