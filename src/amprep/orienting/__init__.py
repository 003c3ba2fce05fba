"""The search for orientations in which a part costs little: candidates, exact figures, and the choice of a few."""
