"""Changes of a packing after the packer: parts that are locked into others, and more equal layers."""
