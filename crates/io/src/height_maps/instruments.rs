//! Files of measuring instruments, read only: one file per format.

mod fields;
