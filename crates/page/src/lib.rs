//! Page: result folders as one HTML file that needs no network.
//!
//! A page is made of the files of a result folder: `summary.json` gives sentences, energies and verdicts, tables give lobes, and
//! the figures are the SVG files of the folder. Nothing is traced or computed anew.

mod cases;
mod comparison;
mod error;
mod figures;
mod folder;
mod lobes;
mod page;
mod rows;
mod story;
mod svg;
mod tables;
mod words;

pub use error::PageError;
pub use page::Page;
