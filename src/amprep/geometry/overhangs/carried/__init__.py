"""Find what of overhang regions the part itself carries."""
