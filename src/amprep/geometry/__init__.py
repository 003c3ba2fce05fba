"""Array mathematics in numpy, scipy and manifold3d: plain arrays in, plain arrays out."""
