"""Union of lattice cells, and unions of support solids."""
