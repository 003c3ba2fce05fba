"""What needs support, which regions block or enforce it, and what stayed unsupported."""
