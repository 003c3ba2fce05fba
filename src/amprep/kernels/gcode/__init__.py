"""Reading of G-code: lines, moves, labels of objects, and what each object extrudes."""
