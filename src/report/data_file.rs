//! [`DataFile`]: which files a sample writes, and their names.

use crate::run::{Report, SampleResult};

/// The data files of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum DataFile {
    Packing,
    Displacement,
    Deflated,
    RadialProfile,
    AngularProfiles,
    #[cfg(feature = "linear")]
    PlasticProfile,
    #[cfg(feature = "linear")]
    Protocol,
}

impl DataFile {
    /// Those of a sample, by what its scene asked for.
    pub(crate) fn of(report: &Report, result: &SampleResult) -> Vec<DataFile> {
        let field = report.scene.observables.displacement_field.is_some();
        let wanted = |file: &DataFile| match file {
            DataFile::Packing | DataFile::Displacement => field,
            DataFile::Deflated => field && result.cycle_field.is_some(),
            DataFile::RadialProfile => result.radial_profile.is_some(),
            DataFile::AngularProfiles => result.angular_profiles.is_some(),
            #[cfg(feature = "linear")]
            DataFile::PlasticProfile => matches!(result.plastic_part, Some(crate::run::PlasticResult::Measured(_))),
            #[cfg(feature = "linear")]
            DataFile::Protocol => crate::report::protocol::measured(result).is_some(),
        };
        let all = [
            DataFile::Packing,
            DataFile::Displacement,
            DataFile::Deflated,
            DataFile::RadialProfile,
            DataFile::AngularProfiles,
            #[cfg(feature = "linear")]
            DataFile::PlasticProfile,
            #[cfg(feature = "linear")]
            DataFile::Protocol,
        ];
        all.into_iter().filter(wanted).collect()
    }

    /// Its name for this sample.
    pub(crate) fn name(self, sample: &str) -> String {
        let ending = match self {
            DataFile::Packing => "packing.xyz",
            DataFile::Displacement => "displacement.xyz",
            DataFile::Deflated => "deflated.xyz",
            DataFile::RadialProfile => "radial_profile.csv",
            DataFile::AngularProfiles => "angular_profiles.csv",
            #[cfg(feature = "linear")]
            DataFile::PlasticProfile => "plastic_profile.csv",
            #[cfg(feature = "linear")]
            DataFile::Protocol => "protocol.csv",
        };
        format!("{sample}.{ending}")
    }
}
