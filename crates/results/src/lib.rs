//! The results of a study: what [`simulate`](asperity_simulate::simulate) finds is kept here, resumed, merged and read.
//!
//! A [`ResultSet`] has a [`Header`], a [`CaseResult`] per case, and the finished parts of cases that are not complete. It runs what is
//! missing, in memory or in a [`ResultFolder`](asperity_io::ResultFolder), and whatever shows or judges results reads it.
//!
//! # Files
//! While a run goes on, what is finished is added to `results.journal`, seldom enough to cost less than 1 % of the time. At the end, or
//! at an interrupt, [`ResultSet::close`] turns all of it into `results.npz`, which `numpy.load` opens: a zip of NPY arrays and JSON. A killed
//! run leaves the journal, whose torn or damaged tail is dropped; [`ResultSet::open`] reads both.
//!
//! | member | what |
//! |---|---|
//! | `header.json` | format, study, build, seed, document, axes, and how many cases there are |
//! | `cases/000000.json` | outcome and findings of a case; a member `{"$array": "NAME"}` stands for the array `NAME.npy` |
//! | `cases/000000/.../means/values.npy` | an array of the case, at its place in the JSON |
//! | `surface.json`, `surface/heights.npy` | a [`Thumbnail`] of the first surface |
//! | `parts.cbor` | finished parts of cases that are not complete, or of all, if more surfaces are to join them; for this program alone |
//! | `machine.json` | seconds, threads, host and instructions: all that differs between two runs of the same results |
//!
//! A number that is not finite is `{"$float": "NaN"}`, `"inf"` or `"-inf"`. In an array with `"missing": "NaN"` a NaN stands for a value
//! that is not there.
//!
//! # What is kept per surface
//! `verify` and `trace` keep the tally of each surface: their tests flip the signs of whole surfaces, and more surfaces can join them.
//! `map`, `gonio` and the runs of `converge` keep moments alone, [without details](asperity_simulate::Outcome::without_details): means, squares of deviations and least
//! errors.
//!
//! # Shards
//! A set of a shard has the cases that it has finished, and finished parts of those that it shares with others. [`Container::merge`] puts the
//! sets of all shards together; running what is missing then finds every part, and so the bytes of the whole run.

mod case_result;
mod error;
mod found;
mod header;
mod npz;
mod pack;
mod set;
mod shards;
mod store;
mod thumbnail;

pub use case_result::{CaseResult, Stored, coordinates};
pub use error::ResultsError;
pub use found::has_results;
pub use header::{Header, Machine};
pub use set::{Container, ResultSet, Resumed};
pub use shards::Shards;
pub use thumbnail::Thumbnail;
