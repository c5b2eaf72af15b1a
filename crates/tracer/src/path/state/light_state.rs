//! Light state: the polarisation of a single path, as required by the polarisation setting.

use asperity_optics::{Stokes, Turn};

use crate::interaction::polarised::{
    AveragedLight, BothLight, CarriedLight, MAX_NUMBERS, MuellerLight, Passage, Passed,
    TrackedLight,
};
use crate::settings::Polarisation;

/// Polarisation of a single path: as many numbers as its treatment requires, then zeros.
#[derive(Clone, Copy)]
pub(crate) struct LightState(pub(crate) [f64; MAX_NUMBERS]);

impl LightState {
    /// Nothing is carried.
    pub(crate) const NONE: Self = Self([0.0; MAX_NUMBERS]);

    /// Light that falls on the surface, of which `stokes` are Q, U and V over I; a Mueller matrix holds for any.
    #[inline]
    pub(crate) const fn incident(polarisation: Polarisation, stokes: [f64; 3]) -> Self {
        let [q, u, v] = stokes;
        match polarisation {
            Polarisation::Averaged => Self::NONE,
            Polarisation::Tracked => widened(stokes),
            Polarisation::Both => widened([q, u, v, 1.0]),
            Polarisation::Mueller => Self(MuellerLight::INCIDENT),
        }
    }

    /// This light in axes that are turned about its ray.
    pub(crate) fn turned(mut self, polarisation: Polarisation, turn: Turn) -> Self {
        let [q, u, v, rest @ ..] = self.0;
        if polarisation != Polarisation::Mueller {
            let Stokes([_, q, u, v]) = Stokes([1.0, q, u, v]).turned(turn);
            self.0[..3].copy_from_slice(&[q, u, v]);
            return self;
        }
        let mut columns = [[1.0, q, u, v], [0.0; 4], [0.0; 4], [0.0; 4]];
        for (column, numbers) in columns[1..].iter_mut().zip(rest.chunks_exact(4)) {
            column.copy_from_slice(numbers);
        }
        let turned = columns.map(|column| Stokes(column).turned(turn).0);
        let mut numbers = turned.into_iter().flatten().skip(1);
        Self([(); MAX_NUMBERS].map(|()| numbers.next().unwrap_or(0.0)))
    }

    /// Q, U and V over I, of light that is tracked.
    #[inline]
    pub(crate) const fn stokes(&self) -> [f64; 3] {
        let [q, u, v, ..] = self.0;
        [q, u, v]
    }

    /// Number of numbers that a path carries.
    #[inline]
    pub(crate) const fn len(polarisation: Polarisation) -> usize {
        match polarisation {
            Polarisation::Averaged => 0,
            Polarisation::Tracked => 3,
            Polarisation::Both => 4,
            Polarisation::Mueller => MAX_NUMBERS,
        }
    }

    /// The measures of the tally divided by the flux, in the order of [`Polarisation::polarimetry`]; entries beyond its length are unused.
    #[inline]
    pub(crate) fn measures(&self, polarisation: Polarisation) -> [f64; MAX_NUMBERS + 1] {
        let mut measures = [1.0; MAX_NUMBERS + 1];
        match polarisation {
            Polarisation::Both => measures[0] -= self.0[3],
            _ => measures[1..].copy_from_slice(&self.0),
        }
        measures
    }

    /// The light after a passage, and its flux per flux that has arrived.
    #[inline]
    pub(crate) fn after(self, polarisation: Polarisation, passage: &Passage) -> (Self, f64) {
        match polarisation {
            Polarisation::Averaged => self.after_as::<AveragedLight, 0>(passage),
            Polarisation::Tracked => self.after_as::<TrackedLight, 3>(passage),
            Polarisation::Both => self.after_as::<BothLight, 4>(passage),
            Polarisation::Mueller => self.after_as::<MuellerLight, MAX_NUMBERS>(passage),
        }
    }

    #[inline]
    fn after_as<L: CarriedLight<N>, const N: usize>(self, passage: &Passage) -> (Self, f64) {
        let Passed { fraction, light } = L::after(self.narrowed(), passage);
        (widened(light), fraction)
    }

    /// The light after its polarisation was lost.
    #[inline]
    pub(crate) fn depolarised(self, polarisation: Polarisation) -> Self {
        match polarisation {
            Polarisation::Averaged => self,
            Polarisation::Tracked => widened(TrackedLight::depolarised(self.narrowed())),
            Polarisation::Both => widened(BothLight::depolarised(self.narrowed())),
            Polarisation::Mueller => Self(MuellerLight::depolarised(self.0)),
        }
    }

    /// The first `N` numbers.
    #[inline]
    fn narrowed<const N: usize>(self) -> [f64; N] {
        std::array::from_fn(|i| self.0[i])
    }
}

/// Pads an array of numbers with zeros to a full state.
#[inline]
const fn widened<const N: usize>(light: [f64; N]) -> LightState {
    let mut state = [0.0; MAX_NUMBERS];
    let mut i = 0;
    while i < N {
        state[i] = light[i];
        i += 1;
    }
    LightState(state)
}
