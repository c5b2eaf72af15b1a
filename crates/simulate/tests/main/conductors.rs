//! Conductors: cases that differ in the index of a conductor alone are traced together, to the bytes of each alone.

use std::sync::Arc;

use asperity_optics::{Incidence, Material};
use asperity_simulate::{
    Case, Estimator, Light, Outcome, Regions, Settings, Silent, Simulation, SurfaceSource, simulate,
};
use asperity_surface::HeightField;
use asperity_synthesis::{Psd, Synthesis};
use asperity_tracer::CpuEngine;

use crate::after::After;
use crate::engines::{Counted, Counts};
use crate::resuming::{Keeper, numbers, resume};
use crate::support::{Rough, effort, glass};

/// Cases of one surface: five conductors and glass at two angles of incidence, in turns.
fn cases(surface: &SurfaceSource) -> Vec<Case> {
    let gold = [0.16, 0.35, 1.1, 1.4, 1.6];
    let gold = gold.map(|eta| Material::conductor(eta, 2.0 / eta).unwrap());
    let materials = gold.into_iter().chain([glass()]);
    let case = |material| {
        [10.0, 60.0].map(|theta| {
            let light = Light::from_above(Incidence::from_degrees(theta, 0.0).unwrap());
            Case::new(surface.clone(), material, light)
        })
    };
    materials.flat_map(case).collect()
}

fn given(n: usize) -> HeightField {
    let psd = Psd::gaussian(2.0, 4.0).unwrap();
    let synthesis = Synthesis::new(psd, [n; 2], [1.0; 2], false).unwrap();
    synthesis.draw(1, 0).unwrap()
}

/// Random surfaces, under control variates too; one given surface, refined and in regions; several given ones.
#[test]
fn conductors_on_one_surface_are_traced_once_and_give_the_bytes_of_each_alone() {
    let random = Rough::smooth(2.0, 4.0, 32).case(glass(), 30.0).surface;
    let one = SurfaceSource::height_field(given(32));
    let regions = Some(Regions {
        columns: 3,
        rows: 2,
    });
    let plain = Settings {
        estimator: Estimator::Plain,
        ..effort(1, 4000)
    };
    let refined = Settings {
        refine: true,
        ..effort(1, 4000)
    };
    for (surface, settings, meshes) in [
        (&random, effort(3, 3000), 1),
        (&one, refined, 3),
        (&one, Settings { regions, ..plain }, 1),
        (&one, plain, 1),
    ] {
        let cases = cases(surface);
        let alone: Vec<Outcome> = cases
            .iter()
            .flat_map(|case| simulate(std::slice::from_ref(case), &settings, &Silent).unwrap())
            .collect();
        let counts = Arc::new(Counts::default());
        let engine = Arc::new(Counted(CpuEngine, counts.clone()));
        let simulation = Simulation::new(&cases, &settings).unwrap().on(engine);
        let together = simulation.run(&Silent).unwrap();
        assert!(numbers(&together) == numbers(&alone), "other numbers");
        let [_, rays, traced] = counts.get();
        let of_case = together[0].work.rays * meshes;
        assert_eq!([rays, traced], [12 * of_case, 4 * of_case]);
    }
}

/// A run that is ended again and again goes on from what all of them have.
#[test]
fn conductors_on_one_given_surface_resume_to_the_same_numbers() {
    let cases = cases(&SurfaceSource::height_field(given(32)));
    let settings = effort(1, 20_000);
    let whole = simulate(&cases, &settings, &Silent).unwrap();
    let all: u64 = whole.iter().map(|one| one.work.rays).sum();
    let keeper = Keeper::default();
    for runs in 1.. {
        // The rays that are resumed count as well.
        let after = After::rays(runs * all / 5);
        let resumed = resume(&cases, &settings, &keeper, &after);
        let is_whole = resumed.iter().all(|one| !one.stopping.is_cut_short());
        if is_whole && resumed.len() == whole.len() {
            assert!(numbers(&resumed) == numbers(&whole), "other numbers");
            assert!(runs > 2);
            break;
        }
        assert!(runs < 20);
    }
}
