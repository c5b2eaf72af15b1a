//! Surface: copies a prepared surface to a device.

use asperity_surface::Border;
use asperity_tracer::{Geometry, HorizonTable, Pyramid, PyramidTable, Shape, Surface};

use crate::device::{Device, DeviceError, Kernel, Memory};
use crate::tables::{SurfaceTable, words};

/// Most cells along a side: kernels begin their searches at one node.
const MAX_CELLS: usize = 1 << 15;

/// A surface in the memory of a device.
pub(crate) struct SurfaceOnDevice {
    pub(crate) kernel: Kernel,
    /// A [`SurfaceTable`].
    pub(crate) table: Box<dyn Memory>,
    /// What the table refers to.
    _arrays: [Box<dyn Memory>; 3],
}

impl SurfaceOnDevice {
    /// Returns `true` if kernels search surfaces of this shape.
    pub(crate) fn supports(shape: &Shape) -> bool {
        let is_alone = shape.surfaces() == 1;
        is_alone
            && match shape {
                Shape::HeightField { top, .. } => {
                    top.border() == Border::Periodic
                        && top.field().turned_cells().is_none()
                        && top.cells().into_iter().all(|cells| cells <= MAX_CELLS)
                }
                _ => false,
            }
    }

    /// Copies a surface; `None` if kernels do not search it.
    pub(crate) fn new(device: &dyn Device, shape: &Shape) -> Result<Option<Self>, DeviceError> {
        if !Self::supports(shape) {
            return Ok(None);
        }
        match shape {
            Shape::HeightField { top, .. } => Self::of_facets(device, top),
            _ => Ok(None),
        }
    }

    fn of_facets(device: &dyn Device, surface: &Surface) -> Result<Option<Self>, DeviceError> {
        let Ok(pyramid) = Pyramid::build(surface) else {
            return Ok(None);
        };
        let [columns, rows] = surface.cells();
        let heights: Vec<f64> = (0..rows).flat_map(|iy| surface.row(iy)).collect();
        let bounds = (pyramid.table(), surface.horizon_table());
        let of = Grid {
            kernel: Kernel::Facets,
            cells: [columns, rows],
            stride: columns,
            z: &heights,
        };
        of.upload(device, surface, bounds).map(Some)
    }
}

/// The numbers of a surface over a grid.
struct Grid<'a> {
    kernel: Kernel,
    cells: [usize; 2],
    stride: usize,
    z: &'a [f64],
}

impl Grid<'_> {
    fn upload<G: Geometry>(
        &self,
        device: &dyn Device,
        geometry: &G,
        (pyramid, horizon): (PyramidTable<'_>, HorizonTable<'_>),
    ) -> Result<SurfaceOnDevice, DeviceError> {
        let arrays = [
            device.upload(bytemuck::cast_slice(self.z))?,
            device.upload(&words(pyramid.nodes))?,
            device.upload(&words(horizon.quadrants))?,
        ];
        let [z, nodes, quadrants] = arrays.each_ref().map(|memory| memory.address());
        let table = SurfaceTable {
            z,
            nodes,
            quadrants,
            cells: self.cells.map(|n| n as i32),
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
        };
        Ok(SurfaceOnDevice {
            kernel: self.kernel,
            table: device.upload(bytemuck::cast_slice(&[table]))?,
            _arrays: arrays,
        })
    }
}
