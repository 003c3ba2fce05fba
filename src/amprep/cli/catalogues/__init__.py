"""Commands that list, show and check printers, materials, cells and plugins."""
