"""Commands that list and show printers and materials."""
