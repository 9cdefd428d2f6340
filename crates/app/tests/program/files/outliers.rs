//! Do a few points and triangles far away take no detail from all others?
