"""Walk over overhanging faces, and flood the surroundings of local minima."""
