//! Image quality metrics in their published profiles, and the registry that names them.
