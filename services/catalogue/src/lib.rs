//! The SQLite catalogue of jobs, scenes, images, measurements and artifacts.
