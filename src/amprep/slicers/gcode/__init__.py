"""Read G-code of PrusaSlicer, SuperSlicer, OrcaSlicer, Bambu Studio and Cura."""
