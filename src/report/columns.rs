//! [`ResponseColumns`]: the response of each disk, as columns of a packing after an inflation.
//!
//! | column | meaning |
//! |---|---|
//! | `displacement` | d = r(after) − r(before), D values \[length\] |
//! | `radial` | d_r, its part away from the inflated disk \[length\] |
//! | `transverse` | d_θ, positive anticlockwise \[length\] |
//! | `counted` | 1 if observables include the disk |
//! | `rattler` | 1 for a mobile disk off the backbone before or after |
//! | `linear` | d_0 u, the linear response of the state before, D values \[length\] |
//! | `plastic` | d − d_0 u, D values \[length\] |
//!
//! All are 0 for held disks and the inflated one. `linear` and `plastic` exist if the linear response was computed, and are 0 for disks that
//! do not count.

use std::path::Path;

use crate::analysis::Analysis;
use crate::displacement::{DisplacementField, MeasuredOn};
use crate::io::{Column, WriteError};
#[cfg(feature = "linear")]
use crate::linear::{LinearError, LinearResponse, Prestress};
#[cfg(feature = "linear")]
use crate::plastic::PlasticPart;
use crate::report::state_file::{law_keys, write_by_ending};
use crate::vector::{Vector, difference};

/// The columns of a response.
pub(crate) struct ResponseColumns<const D: usize> {
    displacement: Vec<Vector<D>>,
    radial: Vec<f64>,
    /// Only in the plane, where it has one component.
    transverse: Option<Vec<f64>>,
    counted: Vec<f64>,
    rattler: Vec<f64>,
    /// The linear and the plastic part.
    parts: Option<[Vec<Vector<D>>; 2]>,
}

impl<const D: usize> ResponseColumns<D> {
    /// The columns of a field in a packing of `count` disks, and of its plastic part, if that is known.
    pub fn of(count: usize, field: &DisplacementField<D>, plastic: Option<&DisplacementField<D>>) -> Self {
        let (zeros, vectors) = (vec![0.0; count], vec![[0.0; D]; count]);
        let mut columns = ResponseColumns {
            displacement: vectors.clone(),
            radial: zeros.clone(),
            transverse: (D == 2).then(|| zeros.clone()),
            counted: zeros.clone(),
            rattler: zeros,
            parts: None,
        };
        // All disks of an unjammed packing are rattlers.
        let jammed = field.measured_on == MeasuredOn::Backbone;
        for disk in &field.disks {
            columns.displacement[disk.disk] = disk.displacement;
            columns.radial[disk.disk] = disk.radial;
            if let Some(transverse) = &mut columns.transverse {
                transverse[disk.disk] =
                    (disk.position[0] * disk.displacement[1] - disk.position[1] * disk.displacement[0]) / disk.distance;
            }
            columns.counted[disk.disk] = f64::from(u8::from(disk.counted));
            columns.rattler[disk.disk] = f64::from(u8::from(!(jammed && disk.counted)));
        }
        if let Some(plastic) = plastic {
            let mut parts = [vectors.clone(), vectors];
            for disk in plastic.counted() {
                parts[0][disk.disk] = difference(columns.displacement[disk.disk], disk.displacement);
                parts[1][disk.disk] = disk.displacement;
            }
            columns.parts = Some(parts);
        }
        columns
    }

    pub fn columns(&self) -> Vec<Column<'_>> {
        fn vector<'a, const D: usize>(name: &'a str, values: &'a [Vector<D>]) -> Column<'a> {
            Column { name, width: D, values: values.as_flattened() }
        }
        let mut all =
            vec![vector("displacement", &self.displacement), Column { name: "radial", width: 1, values: &self.radial }];
        all.extend(self.transverse.as_ref().map(|values| Column { name: "transverse", width: 1, values }));
        all.extend([
            Column { name: "counted", width: 1, values: &self.counted },
            Column { name: "rattler", width: 1, values: &self.rattler },
        ]);
        if let Some([linear, plastic]) = &self.parts {
            all.extend([vector("linear", linear), vector("plastic", plastic)]);
        }
        all
    }
}

/// The response of each disk of an analysis, written with the packing after the inflation.
pub struct DiskResponse<'a, const D: usize = 2> {
    analysis: &'a Analysis<D>,
    columns: ResponseColumns<D>,
    /// Why there is no linear response; none if there is one.
    pub not_linear: Option<String>,
}

impl<'a, const D: usize> DiskResponse<'a, D> {
    /// The response of an analysis. With the feature `linear` it includes the linear response of the state before and the plastic part.
    pub fn of(analysis: &'a Analysis<D>) -> Self {
        #[cfg(feature = "linear")]
        let (plastic, not_linear) = match plastic_part(analysis) {
            Ok(plastic) => (Some(plastic.field), None),
            Err(error) => (None, Some(error.with_labels(analysis.pair.before.labels()).to_string())),
        };
        #[cfg(not(feature = "linear"))]
        let (plastic, not_linear) = (None, Some("the program was built without the feature `linear`".into()));
        let columns = ResponseColumns::of(analysis.pair.after.len(), field_of(analysis), plastic.as_ref());
        DiskResponse { analysis, columns, not_linear }
    }

    /// Writes the packing after the inflation with the columns of the response: a NumPy archive if the name of the file ends in `.npz`,
    /// otherwise extended XYZ.
    ///
    /// # Errors
    /// [`WriteError`] with the file and the problem; nothing is written then.
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        let analysis = self.analysis;
        let mut own = law_keys(&analysis.law);
        own.push(("inflated_disk", analysis.centre_label.to_string()));
        own.push(("increase", format!("{:?}", analysis.increase)));
        own.push(("pressure", format!("{:?}", analysis.after.pressure)));
        if analysis.pair.after.held().contains(&true) {
            own.push(("outer_radius", format!("{:?}", analysis.outer_radius)));
        }
        write_by_ending(path, &analysis.pair.after, &self.columns.columns(), &own, &[])
    }
}

/// The plastic part of an analysis.
#[cfg(feature = "linear")]
fn plastic_part<const D: usize>(analysis: &Analysis<D>) -> Result<PlasticPart<D>, LinearError> {
    let pair = &analysis.pair;
    let linear = LinearResponse::of_inflation(&pair.before, pair.centre, &analysis.law, Prestress::Included)?;
    Ok(PlasticPart::of_field(field_of(analysis).clone(), analysis.increase, &linear))
}

/// The field of an analysis, which has its dimension.
fn field_of<const D: usize>(analysis: &Analysis<D>) -> &DisplacementField<D> {
    &analysis.response.detail.of_dimension().expect("the response has the dimension of its states").field
}
