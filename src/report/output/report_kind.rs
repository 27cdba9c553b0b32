//! [`Kind`]: the type of a report in a folder.

use crate::report::data_file::DataFile;

/// The type of a report in a folder. Reports of different types in one folder are independent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The report of a run.
    Report,
    /// The analysis of states relaxed by other programs.
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

    /// The file that exists if and only if all others do.
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

    /// Prefix of the names of folders that are being filled or complete.
    pub(super) fn prefix(self) -> String {
        format!(".{}-", self.name())
    }
}

/// End of the name of a folder while it is filled, and when it is complete.
pub(super) const PART: &str = ".part";

pub(super) const READY: &str = ".ready";
