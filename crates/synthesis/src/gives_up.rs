//! Question of a drawer: whether it should give up what it draws.

/// Returns `true` once a surface should be given up, and from then on. Asked many times a second, from any thread.
pub type GivesUp<'a> = &'a (dyn Fn() -> bool + Sync);

/// Finishes every surface.
pub const NEVER: GivesUp<'static> = &|| false;
