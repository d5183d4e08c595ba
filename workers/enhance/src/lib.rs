//! Image enhancement: the homomorphic, median and CLAHE chain (HSCM) with its circular mask.
