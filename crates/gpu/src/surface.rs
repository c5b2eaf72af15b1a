//! Surface: copies a prepared surface to a device.

use asperity_surface::Border;
use asperity_tracer::{
    Geometry, HorizonTable, PathSettings, Polarisation, Pyramid, PyramidTable, Shape,
};

use crate::device::{Device, DeviceError, Kernel, Memory};
use crate::tables::{SurfaceTable, upload};

/// Most cells along a side: kernels begin their searches at one node.
const MAX_CELLS: f64 = 32_768.0;

/// A surface in the memory of a device.
pub(crate) struct SurfaceOnDevice {
    /// Kernels for exits without measures of polarised light, and with them.
    kernels: [Kernel; 2],
    /// A [`SurfaceTable`], and behind it the arrays to which it refers.
    pub(crate) table: Box<dyn Memory>,
}

impl SurfaceOnDevice {
    /// Copies a surface; `None` if kernels do not search it.
    pub(crate) fn new(device: &dyn Device, shape: &Shape) -> Result<Option<Self>, DeviceError> {
        if shape.surfaces() > 1 {
            return Ok(None);
        }
        let copied = match shape {
            Shape::HeightField { top, .. } => {
                let is_searched = is_searched(&**top) && top.field().turned_cells().is_none();
                let pyramid = is_searched.then(|| Pyramid::build(&**top).ok());
                let Some(pyramid) = pyramid.flatten() else {
                    return Ok(None);
                };
                // With the far corners of the last cells
                let [columns, rows] = top.cells();
                let row = |iy| top.row(iy).chain([top.z(columns, iy)]);
                let of = Grid {
                    kernels: [Kernel::Facets, Kernel::MeasuredFacets],
                    stride: columns + 1,
                    z: (0..=rows).flat_map(row).collect(),
                };
                of.upload(device, &**top, (pyramid.table(), top.horizon_table()))
            }
            Shape::Smooth { top, .. } => {
                let pyramid = is_searched(&**top).then(|| Pyramid::build(&**top).ok());
                let Some(pyramid) = pyramid.flatten() else {
                    return Ok(None);
                };
                let of = Grid {
                    kernels: [Kernel::Smooth, Kernel::MeasuredSmooth],
                    stride: top.spline().stride(),
                    z: top.coefficients().collect(),
                };
                of.upload(device, &**top, (pyramid.table(), top.horizon_table()))
            }
            _ => return Ok(None),
        };
        copied.map(Some)
    }

    /// The kernel that traces paths with such settings.
    pub(crate) fn kernel(&self, settings: PathSettings) -> Kernel {
        let [plain, measured] = self.kernels;
        match settings.polarisation() {
            Polarisation::Averaged | Polarisation::Tracked => plain,
            Polarisation::Both | Polarisation::Mueller => measured,
        }
    }
}

/// Returns `true` if kernels search a tile of this size.
fn is_searched<G: Geometry>(surface: &G) -> bool {
    surface.extent().into_iter().all(|cells| cells <= MAX_CELLS)
}

/// The numbers of a surface over a grid.
struct Grid {
    kernels: [Kernel; 2],
    /// Numbers in a row of z.
    stride: usize,
    z: Vec<f64>,
}

impl Grid {
    fn upload<G: Geometry>(
        &self,
        device: &dyn Device,
        geometry: &G,
        (pyramid, horizon): (PyramidTable<'_>, HorizonTable<'_>),
    ) -> Result<SurfaceOnDevice, DeviceError> {
        let arrays = [
            bytemuck::cast_slice(&self.z),
            bytemuck::cast_slice(pyramid.nodes),
            bytemuck::cast_slice(horizon.quadrants),
        ];
        let table = upload(device, arrays, |[z, nodes, quadrants]| SurfaceTable {
            z,
            nodes,
            quadrants,
            border: match geometry.border() {
                Border::Periodic => 0,
                Border::Mirrored => 1,
                Border::Open => 2,
            },
            cells: geometry.extent().map(|n| n as i32),
            stride: self.stride as i32,
            lowest_level: pyramid.levels[0] as i32,
            top: pyramid.levels[1] as i32,
            block_level: horizon.level as i32,
            last_block: horizon.last.map(|n| n as i32),
            first_node: pyramid.first,
            node_width: pyramid.width,
            node_scale: pyramid.scale,
            rise_scale: horizon.rises,
            height_scale: horizon.heights,
            all: horizon.all,
            steepest: horizon.all.into_iter().fold(0.0, f64::max),
            reach: geometry.z_range()[1],
            extent: geometry.extent(),
            aspect: geometry.aspect(),
        })?;
        Ok(SurfaceOnDevice {
            kernels: self.kernels,
            table,
        })
    }
}
