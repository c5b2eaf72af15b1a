//! Tables: what kernels read, field by field as in `kernels/tables.h`.

use bytemuck::{Pod, Zeroable};

use crate::device::{Device, DeviceError, Memory};

/// Numbers of counts of work.
pub const COUNTS: usize = 5;

/// Sizes of the tables in bytes, and the number of counts: those that the kernel `table_sizes` reports.
pub const TABLE_SIZES: [u64; 4] = [
    size_of::<SurfaceTable>() as u64,
    size_of::<JobTable>() as u64,
    size_of::<ApertureTable>() as u64,
    COUNTS as u64,
];

/// One tile of a surface.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SurfaceTable {
    pub(crate) z: u64,
    pub(crate) nodes: u64,
    pub(crate) quadrants: u64,
    pub(crate) border: u64,
    pub(crate) cells: [i32; 2],
    pub(crate) stride: i32,
    pub(crate) lowest_level: i32,
    pub(crate) top: i32,
    pub(crate) block_level: i32,
    pub(crate) last_block: [i32; 2],
    pub(crate) first_node: [i32; 16],
    pub(crate) node_width: [i32; 16],
    pub(crate) node_scale: [f64; 2],
    pub(crate) rise_scale: [f64; 2],
    pub(crate) height_scale: [f64; 2],
    pub(crate) all: [f64; 8],
    pub(crate) steepest: f64,
    pub(crate) reach: f64,
    pub(crate) extent: [f64; 2],
    pub(crate) aspect: f64,
}

/// The rays of one call, the light, the material, and where exits are added.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct JobTable {
    pub(crate) surface: u64,
    pub(crate) ring_starts: u64,
    pub(crate) sector_starts: u64,
    pub(crate) apertures: u64,
    pub(crate) fractions: u64,
    pub(crate) sums: u64,
    pub(crate) counts: u64,
    pub(crate) key: [u64; 2],
    pub(crate) first_path: u64,
    pub(crate) strata: u32,
    pub(crate) batches: u32,
    pub(crate) first_stratum: u32,
    pub(crate) turns: u32,
    pub(crate) corner: [f64; 2],
    pub(crate) size: [f64; 2],
    pub(crate) wi: [f64; 3],
    pub(crate) start_z: f64,
    pub(crate) to_mean_plane: f64,
    pub(crate) incident: f64,
    pub(crate) roulette: f64,
    pub(crate) eta: f64,
    pub(crate) kappa: f64,
    pub(crate) reflectance: f64,
    pub(crate) stokes: [f64; 3],
    pub(crate) absorbed_fraction: f64,
    pub(crate) shadow_probability: f64,
    pub(crate) polarisation: u32,
    pub(crate) on_surface: u32,
    pub(crate) material: u32,
    pub(crate) picks: u32,
    pub(crate) max_order: u32,
    pub(crate) n_theta: u32,
    pub(crate) n_phi: u32,
    pub(crate) has_azimuths: u32,
    pub(crate) records: [u32; 2],
    pub(crate) first_edge: [f64; 2],
    pub(crate) forward: f64,
    pub(crate) half_width: f64,
    pub(crate) scale: f64,
    pub(crate) orders: u32,
    pub(crate) paths: u32,
    pub(crate) rings: u32,
    pub(crate) in_plane: u32,
    pub(crate) bins: u32,
    pub(crate) hits: u32,
    pub(crate) absorbed: u32,
    pub(crate) truncated: u32,
    pub(crate) lost: u32,
    pub(crate) not_recorded: u32,
    pub(crate) left_patch: u32,
    pub(crate) measures: u32,
    pub(crate) of_apertures: u32,
    pub(crate) aperture_count: u32,
    pub(crate) along: [f64; 3],
    pub(crate) across: [f64; 3],
}

/// A narrow window about one direction.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ApertureTable {
    pub(crate) side: f64,
    pub(crate) centre: [f64; 3],
    pub(crate) cos_reach: f64,
    pub(crate) theta: f64,
    pub(crate) is_receptor: f64,
    pub(crate) in_plane: [f64; 2],
    pub(crate) across: [f64; 2],
}

/// Copies a table to a device, and behind it the arrays to which it refers: `table` is given their addresses, which are zero for empty ones.
pub(crate) fn upload<T: Pod, const N: usize>(
    device: &dyn Device,
    arrays: [&[u8]; N],
    table: impl FnOnce([u64; N]) -> T,
) -> Result<Box<dyn Memory>, DeviceError> {
    const WORD: usize = size_of::<u64>();
    let mut words = vec![0_u64; size_of::<T>().div_ceil(WORD)];
    let offsets = arrays.map(|array| {
        let first = words.len();
        words.resize(first + array.len().div_ceil(WORD), 0);
        bytemuck::cast_slice_mut(&mut words[first..])[..array.len()].copy_from_slice(array);
        (!array.is_empty()).then_some(first * WORD)
    });
    let mut memory = device.zeros(words.len())?;
    let address = |offset: usize| memory.address() + offset as u64;
    let table = table(offsets.map(|offset| offset.map_or(0, address)));
    bytemuck::cast_slice_mut(&mut words)[..size_of::<T>()]
        .copy_from_slice(bytemuck::bytes_of(&table));
    memory.write(&words)?;
    Ok(memory)
}
