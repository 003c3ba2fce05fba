"""Pack parts on plates without stacking, and compare packers and a 2D nesting package."""
