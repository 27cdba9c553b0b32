//! Files, runs, reports and studies, in the library and from the command line.

mod analysis;
#[cfg(feature = "cli")]
mod any_field;
#[cfg(feature = "cli")]
mod columns;
#[cfg(feature = "cli")]
mod command_line;
#[cfg(feature = "cli")]
mod drives;
#[cfg(all(feature = "fit", feature = "linear"))]
mod ensembles;
#[cfg(feature = "cli")]
mod exact_command;
#[cfg(feature = "cli")]
mod fuzz;
mod io;
#[cfg(feature = "cli")]
mod output_folder;
#[cfg(feature = "cli")]
mod packing_commands;
#[cfg(feature = "linear")]
mod precision;
mod report;
#[path = "../scenes/seeds.rs"]
mod seeds;
#[cfg(feature = "cli")]
mod sizes;
mod spheres;
#[cfg(feature = "cli")]
mod spheres_analysed;
#[cfg(feature = "cli")]
mod strain_command;
#[cfg(feature = "cli")]
mod strips;
mod structure;
mod study;
#[cfg(feature = "cli")]
mod study_command;
#[cfg(feature = "cli")]
mod study_folder;
#[cfg(feature = "fit")]
mod transition;
#[cfg(feature = "cli")]
mod verdict;
