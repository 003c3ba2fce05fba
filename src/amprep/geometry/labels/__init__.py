"""Text as solids on flat faces of meshes."""
