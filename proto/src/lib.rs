//! Wire messages between service and worker.
