//! [`Kind`]: what a folder is filled with.

use crate::report::data_file::DataFile;

/// What a folder is filled with. Reports of different kinds in one folder know nothing of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The report of a run.
    Report,
    /// The analysis of states relaxed elsewhere.
    Analysis,
    /// Error against cost.
    Precision,
}

impl Kind {
    /// Name of its document without the ending.
    pub(super) fn name(self) -> &'static str {
        match self {
            Kind::Report => "report",
            Kind::Analysis => "analysis",
            Kind::Precision => "precision",
        }
    }

    /// The file that is there if and only if all others are.
    pub(super) fn document(self) -> String {
        format!("{}.json", self.name())
    }

    /// The list of files.
    pub(super) fn manifest(self) -> String {
        format!(".{}.files.json", self.name())
    }

    /// The longest ending of a file that has the name of its sample.
    pub(super) fn longest_ending(self) -> &'static str {
        match self {
            Kind::Report | Kind::Analysis => DataFile::longest_ending(),
            Kind::Precision => "displacement_factorisations.svg",
        }
    }

    /// How the names of folders begin that are filled or ready.
    pub(super) fn prefix(self) -> String {
        format!(".{}-", self.name())
    }
}

/// How the name of a folder ends while it is filled, and when it is complete.
pub(super) const PART: &str = ".part";

pub(super) const READY: &str = ".ready";
