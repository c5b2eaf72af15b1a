//! Names that several settings allow.

use crate::settings::kind::{Choice, Kind, choice};

pub(super) const BORDER: Kind = Kind::Choice(&[
    choice("periodic", "the tile is repeated"),
    choice("mirrored", "the tile is mirrored at its border"),
    choice(
        "open",
        "nothing lies beyond: light that leaves upwards escapes, the rest is truncated",
    ),
]);

pub(super) const DRAWN_BORDER: Kind = Kind::Choice(&[
    choice("periodic", "the tile is repeated"),
    choice("open", "rays that leave the patch past its border escape"),
]);

pub(super) const CELLS: Kind = Kind::Choice(&[
    choice(
        "auto",
        "smooth for random surfaces without edges, flat for others and for given ones",
    ),
    choice("flat", "two triangles per cell"),
    choice(
        "smooth",
        "bicubic B-splines, continuous in slope and curvature",
    ),
]);

pub(super) const STRUCTURE: Kind = Kind::Choice(&[
    choice("pits", "spherical pits"),
    choice("caps", "spherical caps, such as microlenses"),
    choice("v-grooves", "grooves with two flanks of the same angle"),
    choice("sine-grooves", "grooves with a sine for a profile"),
    choice("blazed-grooves", "grooves with facets at right angles"),
    choice("scratches", "straight V scratches, as on brushed metal"),
    choice("cracks", "V cracks along a random Voronoi network"),
    choice("pyramids", "square pyramids"),
    choice(
        "inverted-pyramids",
        "square pyramids pressed into the plane",
    ),
]);

pub(super) const ARRANGEMENT: Kind = Kind::Choice(&[
    choice("lattice", "hexagonal, of pyramids square"),
    choice("random", "each independent of the others; they overlap"),
    choice("separate", "at random without overlap; not of pyramids"),
]);

pub(super) const UNIT: Kind = Kind::Choice(&[
    choice("nm", "nanometre"),
    choice("um", "micrometre"),
    choice("mm", "millimetre"),
    choice("m", "metre"),
    choice("km", "kilometre"),
]);

pub(super) const UP: Kind = Kind::Choice(&[
    choice("x", "x points up"),
    choice("y", "y points up, as in OBJ files of Blender"),
    choice("z", "z points up"),
]);

pub(super) const DRAWN_UNIT: Kind = Kind::Choice(&[
    choice("1", "arbitrary"),
    choice("nm", "nanometre"),
    choice("um", "micrometre"),
    choice("mm", "millimetre"),
    choice("m", "metre"),
    choice("km", "kilometre"),
]);

pub(super) const SURFACE_FORMAT: Kind = Kind::Choice(&[
    choice("exr", "OpenEXR"),
    choice("npy", "NumPy, heights alone"),
    choice("gsf", "Gwyddion Simple Field"),
    choice("x3p", "ISO 25178-72"),
    choice("png", "pictures for viewing"),
]);

pub(super) const MESH_FORMAT: Kind = Kind::Choice(&[
    choice("ply", "PLY, binary"),
    choice("obj", "Wavefront OBJ"),
    choice("stl", "STL"),
]);

pub(super) const EXPORT_FORMAT: Kind = Kind::Choice(&[
    choice("netcdf", "labelled arrays for xarray, MATLAB, Julia and R"),
    choice("klems", "XML with matrices of slabs, as Radiance reads"),
    choice("tensor-tree", "XML of Radiance with cells as fine as lobes"),
    choice("rgl", ".bsdf of Mitsuba 3 (spectral variants) and pbrt-v4"),
    choice("rgl-rgb", ".bsdf of Mitsuba 3 (rgb variants)"),
    choice(
        "pbsdf",
        "Mueller matrices as .pbsdf of Mitsuba 3 (spectral polarised variants)",
    ),
    choice("zemax", "tabular BSDF of OpticStudio, of one side"),
    choice(
        "fit",
        "parameters of ABg, Harvey-Shack, GGX and others as JSON",
    ),
    choice("ssdd", "open text tables of both sides, as libbsdf reads"),
]);

pub(super) const FOR_FORMAT: Kind = Kind::Choice(&[
    choice("netcdf", "the same bins for all directions"),
    choice("klems", "patches lit as a whole from both sides"),
    choice(
        "tensor-tree",
        "light of 17 polar angles up to 88 degrees, from both sides",
    ),
    choice("rgl", "17 polar angles of the light up to 88 degrees"),
    choice("rgl-rgb", "those of rgl"),
    choice("pbsdf", "those of rgl, with Mueller matrices"),
    choice("zemax", "polar angles of the light from 0 to 80 degrees"),
    choice("fit", "polar angles of the light from 0 to 60 degrees"),
    choice("ssdd", "polar angles of the light from 0 to 80 degrees"),
]);

pub(super) const DIRECTIONS: Kind = Kind::GridOrChoice(&[choice(
    "klems",
    "patches of the full Klems basis, one per ring if the azimuth is random",
)]);

pub(super) const EXPORTED_SIDE: Kind = Kind::Choice(&[
    choice("reflected", "reflected light"),
    choice("transmitted", "transmitted light"),
]);

pub(super) const MISSING: Kind = Kind::Choice(&[
    choice("refuse", "the file is refused"),
    choice("fill", "they are interpolated"),
]);

pub(super) const FORM: Kind = Kind::Choice(&[
    choice("none", "nothing"),
    choice("mean", "the mean height"),
    choice("plane", "the least-squares plane"),
    choice("parabola", "the least-squares paraboloid"),
]);

pub(super) const MATERIAL: Kind = Kind::ChoiceOrMaterial(&[
    choice(
        "dielectric",
        "reflects and transmits; --eta is n_transmitted / n_incident",
    ),
    choice(
        "conductor",
        "reflects and absorbs; its index is eta + i kappa",
    ),
    choice("mirror", "reflects everything"),
    choice(
        "lambertian",
        "facets reflect the fraction --reflectance diffusely and absorb the rest",
    ),
]);

pub(super) const FROM: Kind = Kind::Choice(&[
    choice("above", "above the surface"),
    choice("below", "below the surface"),
]);

/// The sides of [`FROM`], and both.
pub(super) const FROM_EITHER: Kind = Kind::Choice(&[
    choice("above", "above the surface"),
    choice("below", "below the surface, or below the layers under it"),
    choice("both", "one after the other, on one sample"),
]);

pub(super) const AZIMUTH: Kind = Kind::Choice(&[
    choice(
        "random",
        "each ray has its own; results are rotated back to --phi",
    ),
    choice("fixed", "all light comes from --phi"),
]);

pub(super) const PHASE: Kind = Kind::Choice(&[
    choice("isotropic", "uniform over directions"),
    choice("henyey-greenstein", "by the mean cosine --g"),
    choice("rayleigh", "particles much smaller than the wavelength"),
]);

pub(super) const BOTTOM: Kind = Kind::Choice(&[
    choice("open", "light leaves without deviation"),
    choice("interface", "reflects and refracts, by --bottom-eta"),
    choice("absorbing", "absorbs all light"),
    choice("mirror", "reflects all light"),
    choice("lambertian", "diffuse, by --bottom-reflectance"),
]);

/// Shapes of a bottom.
const FLAT: Choice = choice("flat", "a plane");
const SAME: Choice = choice("same", "the surface above, moved down");

/// Bottoms below given surfaces.
pub(super) const GIVEN_BOTTOMS: &[Choice] = &[FLAT, SAME];

/// Bottoms below random surfaces.
pub(super) const RANDOM_BOTTOMS: &[Choice] = &[
    FLAT,
    SAME,
    choice("independent", "another random surface of the same kind"),
];

pub(super) const SIDE: Kind = Kind::Choice(&[
    choice("both", "reflected and transmitted light"),
    choice("reflected", "reflected light alone"),
    choice("transmitted", "transmitted light alone"),
]);

pub(super) const BRANCHING: Kind = Kind::Choice(&[
    choice(
        "auto",
        "with a target error what the pilot run finds best, else split",
    ),
    choice("split", "follow the reflected and the transmitted branch"),
    choice("pick", "pick one at random"),
]);

pub(super) const BRANCHINGS: Kind = Kind::Choice(&[
    choice("split", "follow the reflected and the transmitted branch"),
    choice("pick", "pick one at random"),
]);

pub(super) const POLARISATION: Kind = Kind::Choice(&[
    choice("tracked", "carried along each path"),
    choice("averaged", "unpolarised again at every interface"),
    choice("both", "tracked, and how averaged light differs"),
    choice("mueller", "tracked, with Mueller matrices"),
]);

/// The first two of [`POLARISATION`].
pub(super) const AVERAGING: Kind = Kind::Choice(&[
    choice("tracked", "carried along each path"),
    choice(
        "averaged",
        "unpolarised again at every interface, as in renderers",
    ),
]);

pub(super) const ALBEDO_SLOPES: Kind = Kind::Choice(&[
    choice("gaussian", "those of Gaussian heights (Beckmann)"),
    choice("ggx", "GGX: long tails"),
]);

pub(super) const BINS: Kind = Kind::GridOrChoice(&[choice(
    "auto",
    "18x36, refined around lobes that are narrower than such bins",
)]);

pub(super) const ROULETTE: Kind = Kind::NumberOrChoice(&[choice(
    "auto",
    "with a target error what the pilot run finds best, else 0.01",
)]);

pub(super) const ACCELERATOR: Kind = Kind::Choice(&[
    choice("auto", "flat or pyramid for height maps, mesh for meshes"),
    choice("mesh", "bounding volumes of triangles"),
    Choice {
        alias: Some("tiles"),
        ..choice("pyramid", "minimum and maximum heights of squares")
    },
    choice("flat", "flat surfaces only"),
    choice("brute-force", "all facets"),
]);

pub(super) const ENGINE: Kind = Kind::Choice(&[
    choice("auto", "a GPU if there is one, otherwise the CPU"),
    choice("cpu", "the CPU"),
    choice(
        "gpu",
        "the first NVIDIA GPU; what it does not trace goes to the CPU",
    ),
]);

pub(super) const ESTIMATOR: Kind = Kind::Choice(&[
    choice("auto", "the one expected to need the least time"),
    choice("plain", "rays from above"),
    choice(
        "controlled",
        "unshadowed single scattering as control variate",
    ),
]);

pub(super) const SAMPLING: Kind = Kind::Choice(&[
    choice("random", "independent points"),
    choice("stratified", "one point per stratum"),
    choice("quasi-random", "a low-discrepancy sequence"),
]);

pub(super) const QUANTITY: Kind = Kind::Choice(&[
    choice("reflected", "flux fraction of reflected light"),
    choice("transmitted", "flux fraction of transmitted light"),
    choice("absorbed", "flux fraction of absorbed light"),
    choice("bins", "bins, relative"),
    choice("rings", "rings of equal polar angle, relative"),
    choice("in-plane", "bins of the in-plane slice, relative"),
]);

pub(super) const COHERENT: Kind = Kind::Choice(&[
    choice("none", "rays alone"),
    choice(
        "kirchhoff",
        "the coherent fraction of a flat sample's light, by the Kirchhoff approximation",
    ),
]);

pub(super) const SCALE: Kind = Kind::Choice(&[
    choice("common", "all discs of a figure"),
    choice("rows", "the discs of one angle of incidence"),
]);

pub(super) const CAMERA: Kind = Kind::Choice(&[
    choice("pinhole", "perspective"),
    choice("orthographic", "parallel lines of sight"),
]);

pub(super) const TONE: Kind = Kind::Choice(&[
    choice(
        "reinhard",
        "Reinhard et al. 2002: highlights are compressed, not clipped",
    ),
    choice("linear", "in proportion to radiance, clipped at white"),
    choice("log", "three decades of radiance in equal steps of grey"),
]);

pub(super) const HEIGHTS: Kind =
    Kind::ChoiceOrFile(&[choice("gaussian", "Gaussian, or by skewness and kurtosis")]);
pub(super) const PSD: Kind = Kind::ChoiceOrFile(&[
    choice("gaussian", "Gaussian autocorrelation"),
    choice(
        "exponential",
        "Exponential autocorrelation, without waves shorter than cut_off",
    ),
    choice("matern", "Matern family, between the two, by nu"),
    choice("power-law", "Self-affine, by hurst, roll_off and cut_off"),
]);
pub(super) const SLOPES: Kind = Kind::Choice(&[
    choice("gaussian", "Those of Gaussian heights"),
    choice("ggx", "GGX, by ggx_alpha: long tails"),
]);
