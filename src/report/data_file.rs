//! [`DataFile`]: the files of a sample and their names.

use crate::report::csv::response::{ResponseFile, every_ending, files};
use crate::run::{Report, SampleResult};

/// The data files of a sample.
#[derive(Clone, Copy)]
pub(crate) enum DataFile {
    Packing,
    Before,
    Displacement,
    Deflated,
    OfResponse(&'static ResponseFile),
    #[cfg(feature = "linear")]
    PlasticProfile,
    #[cfg(feature = "linear")]
    DriveModes,
    #[cfg(feature = "linear")]
    Protocol,
}

impl DataFile {
    /// The files of a sample, by the requests of its scene.
    pub(crate) fn of(report: &Report, result: &SampleResult) -> Vec<DataFile> {
        let mut all = Vec::new();
        if report.scene.observables.displacement_field.is_some() {
            all.extend([DataFile::Packing, DataFile::Before, DataFile::Displacement]);
            all.extend(result.states.largest_cycle_displacement().map(|_| DataFile::Deflated));
        }
        all.extend(files(&result.response).map(DataFile::OfResponse));
        #[cfg(feature = "linear")]
        {
            let plastic = result.plastic_part.as_ref().and_then(|it| it.measured());
            all.extend(plastic.map(|_| DataFile::PlasticProfile));
            let drive = result.drive.as_ref().and_then(|it| it.measured());
            all.extend(drive.map(|_| DataFile::DriveModes));
            all.extend(crate::report::protocol::measured(result).map(|_| DataFile::Protocol));
        }
        all
    }

    /// The longest of all endings.
    pub(crate) fn longest_ending() -> &'static str {
        let all = [DataFile::Packing, DataFile::Before, DataFile::Displacement, DataFile::Deflated];
        #[cfg(feature = "linear")]
        let all = [&all[..], &[DataFile::PlasticProfile, DataFile::DriveModes, DataFile::Protocol]].concat();
        let endings = all.into_iter().map(DataFile::ending).chain(every_ending());
        endings.max_by_key(|ending| ending.len()).unwrap_or_default()
    }

    /// Its name for this sample.
    pub(crate) fn name(self, sample: &str) -> String {
        format!("{sample}.{}", self.ending())
    }

    fn ending(self) -> &'static str {
        match self {
            DataFile::Packing => "packing.xyz",
            DataFile::Before => "before.xyz",
            DataFile::Displacement => "displacement.xyz",
            DataFile::Deflated => "deflated.xyz",
            DataFile::OfResponse(file) => file.ending,
            #[cfg(feature = "linear")]
            DataFile::PlasticProfile => "plastic_profile.csv",
            #[cfg(feature = "linear")]
            DataFile::DriveModes => "drive_modes.csv",
            #[cfg(feature = "linear")]
            DataFile::Protocol => "protocol.csv",
        }
    }
}
