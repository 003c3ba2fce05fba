"""What a printer takes for a build, and what its recoater blade meets."""
