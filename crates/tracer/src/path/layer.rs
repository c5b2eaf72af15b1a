//! Layer: free flights inside the layer below a surface, scattering in its medium, and its bottom.

pub(crate) mod bottom;
pub(crate) mod flight;
pub(crate) mod flight_query;
pub(crate) mod medium;
