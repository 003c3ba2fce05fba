"""3MF packages as zip files: opened with limits, scanned, repaired, written."""
