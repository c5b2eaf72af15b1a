//! Job: the rays of one call, their light and material, and the tallies that they are added to, as kernels read them.

use asperity_optics::Material;
use asperity_tally::{ApertureWindow, ControlVariate, Tallies, TallyLayout, TallySpec};
use asperity_tracer::{
    BatchedRays, Beam, Branching, Geometry, HalfSpace, Illumination, PathSettings, PathStream,
    Polarisation, Sampling, Shape, Starts,
};

use crate::tables::{ApertureTable, JobTable};

/// A case that kernels trace: one material over no layers.
#[derive(Clone, Copy)]
pub(crate) struct Case {
    pub(crate) material: Material,
    pub(crate) incident: HalfSpace,
    pub(crate) settings: PathSettings,
}

impl Case {
    /// Returns `true` if kernels scatter light at this material.
    pub(crate) fn is_supported(&self) -> bool {
        matches!(
            self.material,
            Material::Dielectric { .. }
                | Material::Conductor { .. }
                | Material::Mirror
                | Material::Lambertian { .. }
        )
    }
}

/// The beam of a case on a surface, and an upper bound of the slope of its facets.
fn beam(case: &Case, shape: &Shape, light: &Illumination) -> (Beam, f64) {
    fn of<G: Geometry>(surface: &G, case: &Case, light: &Illumination) -> (Beam, f64) {
        let beam = Beam::new(surface, case.incident, light.incidence, light.window);
        (beam, surface.steepest_slope())
    }
    match shape {
        Shape::HeightField { top, .. } => of(&**top, case, light),
        Shape::Smooth { top, .. } => of(&**top, case, light),
        Shape::TriangleMesh { top, .. } => of(&**top, case, light),
    }
}

/// Rays of several batches of a case, and their light.
#[derive(Clone, Copy)]
pub(crate) struct Rays<'a> {
    pub(crate) case: Case,
    pub(crate) shape: &'a Shape,
    pub(crate) illumination: &'a Illumination,
    pub(crate) rays: &'a BatchedRays,
    pub(crate) stream: PathStream,
}

impl Rays<'_> {
    /// Returns `true` if kernels start such rays.
    pub(crate) fn are_supported(&self) -> bool {
        let light = self.illumination;
        light.spread.is_none() && light.sampling == Sampling::Stratified
    }

    fn turns(&self) -> bool {
        self.illumination.turns(self.case.settings.polarisation())
    }

    /// Number of rays.
    pub(crate) fn count(&self) -> u64 {
        u64::from(self.rays.batches()) * self.rays.part().len() as u64
    }

    /// Empty tallies, as those of the CPU engine.
    pub(crate) fn tallies<'c>(
        &self,
        spec: TallySpec,
        control: Option<&'c ControlVariate>,
    ) -> Tallies<'c> {
        let light = self.illumination;
        let (beam, steepest) = beam(&self.case, self.shape, light);
        let polarisation = self.case.settings.polarisation();
        let tally = beam.tally(light, polarisation, steepest, spec, control);
        Tallies::new(tally, self.rays.batches() as usize)
    }

    /// The job of these rays, without the addresses of memory.
    pub(crate) fn job(&self, layout: &TallyLayout, control: Option<&ControlVariate>) -> JobTable {
        let (case, light) = (&self.case, self.illumination);
        let (beam, _) = beam(case, self.shape, light);
        let ([corner, size], [start_z, to_mean_plane]) = (beam.window(), beam.heights());
        let (key, first_path) = self.stream.key();
        let (material, [eta, kappa, reflectance]) = match case.material {
            Material::Dielectric { eta } => (0, [eta, 0.0, 0.0]),
            Material::Conductor { eta, kappa } => (1, [eta, kappa, 0.0]),
            Material::Lambertian { reflectance } => (3, [0.0, 0.0, reflectance]),
            _ => (2, [0.0; 3]),
        };
        let edges = layout.edges.as_ref();
        let [forward, half_width] = layout.slice.unwrap_or_default();
        JobTable {
            surface: 0,
            ring_starts: 0,
            sector_starts: 0,
            apertures: 0,
            fractions: 0,
            sums: 0,
            counts: 0,
            key,
            first_path,
            strata: self.rays.strata(),
            batches: self.rays.batches(),
            first_stratum: self.rays.part().start,
            turns: self.turns().into(),
            corner,
            size,
            wi: beam.wi().to_array(),
            start_z,
            to_mean_plane,
            incident: case.incident.sign(),
            roulette: case.settings.roulette(),
            eta,
            kappa,
            reflectance,
            stokes: light.stokes,
            absorbed_fraction: control.map_or(0.0, ControlVariate::absorbed_fraction),
            shadow_probability: control.map_or(1.0, ControlVariate::shadow_probability),
            polarisation: match case.settings.polarisation() {
                Polarisation::Averaged => 0,
                Polarisation::Tracked => 1,
                Polarisation::Both => 2,
                Polarisation::Mueller => 3,
            },
            on_surface: (light.starts == Starts::OnSurface).into(),
            material,
            picks: (case.settings.branching() == Branching::Pick).into(),
            max_order: case.settings.max_order(),
            n_theta: layout.n_theta as u32,
            n_phi: layout.n_phi as u32,
            has_azimuths: layout.slice.is_some().into(),
            records: layout.records.map(u32::from),
            first_edge: edges.map_or([0.0; 2], |sides| sides.each_ref().map(|of| of.first_edge)),
            forward,
            half_width,
            scale: layout.scale,
            orders: layout.orders as u32,
            paths: layout.paths as u32,
            rings: layout.rings as u32,
            in_plane: layout.in_plane as u32,
            bins: layout.bins as u32,
            hits: layout.hits as u32,
            absorbed: layout.absorbed as u32,
            truncated: layout.truncated as u32,
            lost: layout.lost as u32,
            not_recorded: layout.not_recorded as u32,
            left_patch: layout.left_patch as u32,
            measures: layout.measures as u32,
            of_apertures: layout.of_apertures as u32,
            aperture_count: layout.apertures.len() as u32,
            along: layout.axes[0],
            across: layout.axes[1],
        }
    }
}

/// An aperture as kernels read it.
pub(crate) fn aperture(window: &ApertureWindow) -> ApertureTable {
    let [in_plane, across] = window.receptor.unwrap_or_default();
    ApertureTable {
        side: window.side.index() as f64,
        centre: window.centre,
        cos_reach: window.cos_reach,
        theta: window.theta,
        is_receptor: if window.receptor.is_some() { 1.0 } else { 0.0 },
        in_plane,
        across,
    }
}
