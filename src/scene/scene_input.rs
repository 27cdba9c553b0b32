//! [`Written`]: the form of a scene in a file, in which a protocol may set the relaxers.

use serde::{Deserialize, Deserializer};

use crate::inflation::{Boundary, Inflation};
use crate::law::choice::LawChoice;
use crate::packing::Mixture;
use crate::relax::RelaxerChoice;
use crate::scene::definition::{PreparationSettings, Sample, Scene};
use crate::scene::observables::Observables;
use crate::scene::protocol::ProtocolChoice;
use crate::scene::source::Source;
use crate::verdict::VerdictSettings;

/// The fields of a [`Scene`], and `protocol`, which sets the relaxer of samples without one.
#[derive(Deserialize)]
#[serde(rename = "Scene", deny_unknown_fields, default)]
pub(super) struct Written {
    dimension: usize,
    protocol: Option<ProtocolChoice>,
    disk_count: usize,
    law: LawChoice,
    mixture: Mixture,
    preparation: PreparationSettings,
    inflation: Inflation,
    observables: Option<Observables>,
    verdict: VerdictSettings,
    sample: Option<Vec<WrittenSample>>,
}

/// A [`Sample`] with or without a relaxer.
#[derive(Deserialize)]
#[serde(rename = "Sample", deny_unknown_fields)]
struct WrittenSample {
    name: String,
    #[serde(default = "first_seed")]
    seed: u64,
    source: Source,
    relaxer: Option<RelaxerChoice>,
}

fn first_seed() -> u64 {
    1
}

impl Default for Written {
    /// The built-in scene.
    fn default() -> Self {
        let Scene { dimension, disk_count, law, mixture, preparation, inflation, verdict, .. } = Scene::default();
        let (protocol, observables, sample) = (None, None, None);
        Written { dimension, protocol, disk_count, law, mixture, preparation, inflation, observables, verdict, sample }
    }
}

impl WrittenSample {
    fn complete(self, protocol: ProtocolChoice, dimension: usize) -> Sample {
        let WrittenSample { name, seed, source, relaxer } = self;
        Sample { relaxer: relaxer.unwrap_or_else(|| protocol.relaxer_in(dimension, &source)), name, seed, source }
    }
}

impl<'de> Deserialize<'de> for Scene {
    fn deserialize<R: Deserializer<'de>>(reader: R) -> Result<Self, R::Error> {
        Written::deserialize(reader).map(Scene::from)
    }
}

/// As a [`Scene`], but without samples unless the file has some: the scene of a study.
pub(crate) fn without_samples<'de, R: Deserializer<'de>>(reader: R) -> Result<Scene, R::Error> {
    let mut written = Written::deserialize(reader)?;
    written.sample.get_or_insert_default();
    Ok(Scene::from(written))
}

impl From<Written> for Scene {
    fn from(written: Written) -> Self {
        let Written { dimension, disk_count, law, mixture, preparation, inflation, verdict, .. } = written;
        let (protocol, sample) = (written.protocol.unwrap_or_default(), written.sample);
        let observables = written.observables.unwrap_or_else(|| match inflation.boundary {
            Boundary::HeldWalls { .. } => Observables::of_strip(),
            Boundary::HeldRim { .. } | Boundary::Periodic => Observables::of_dimension(dimension),
        });
        let sample = match sample {
            Some(sample) => sample.into_iter().map(|sample| sample.complete(protocol, dimension)).collect(),
            None => {
                let by_protocol =
                    |sample: Sample| Sample { relaxer: protocol.relaxer_in(dimension, &sample.source), ..sample };
                Scene::in_dimension(dimension).sample.into_iter().map(by_protocol).collect()
            }
        };
        Scene { dimension, disk_count, law, mixture, preparation, inflation, observables, verdict, sample }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::relax::Fire;

    fn scene(text: &str) -> Scene {
        serde_json::from_str(text).expect("a scene")
    }

    #[test]
    fn a_protocol_is_the_relaxer_of_samples_without_one() {
        let samples = r#""sample": [{"name": "a", "source": {"pressure": 1.0}}, {"name": "b", "source": {"packing_fraction": 0.8}},
            {"name": "c", "source": {"pressure": 1.0}, "relaxer": {"quasi_newton": {}}}]"#;
        for protocol in ProtocolChoice::ALL {
            let text = format!("{{\"protocol\": \"{}\", {samples}}}", protocol.name());
            let relaxers = scene(&text).sample.iter().map(|sample| sample.relaxer).collect::<Vec<_>>();
            let expected = [
                protocol.relaxer(),
                RelaxerChoice::Fire(Fire::default()),
                RelaxerChoice::QuasiNewton(Default::default()),
            ];
            assert_eq!(relaxers, expected);
        }
        let default = scene(&format!("{{{samples}}}")).sample[0].relaxer;
        assert_eq!(default, ProtocolChoice::default().relaxer());
        assert_eq!(scene("{}"), Scene::default());
        let constant = scene(r#"{"protocol": "constant"}"#).sample;
        assert_eq!(constant[1].relaxer, ProtocolChoice::Constant.relaxer());
        assert_eq!(constant[0], Scene::default().sample[0]);
    }

    #[test]
    fn what_is_written_is_read_back() {
        let scene = Scene { disk_count: 77, ..Scene::default() };
        let text = serde_json::to_string(&scene).expect("plain data");
        assert_eq!(serde_json::from_str::<Scene>(&text).expect("a scene"), scene);
    }
}
