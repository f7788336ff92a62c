//! E57: scans as columns of numbers.
