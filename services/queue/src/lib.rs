//! Leases on frames: grant, beat, fence, expire, strike; and the worker's client over HTTP.
