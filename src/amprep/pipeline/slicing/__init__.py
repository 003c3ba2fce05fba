"""Cut a build into layers and write their contours."""
