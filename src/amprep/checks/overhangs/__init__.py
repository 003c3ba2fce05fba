"""What the judges find of overhangs; no code is shared with the planner's search."""
