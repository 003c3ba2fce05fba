"""Finding overhanging faces, edges and tips."""
